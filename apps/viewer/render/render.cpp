#include "apps/viewer/render/render.h"

#include "apps/viewer/render/shaders.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <epoxy/gl.h>
#include <stdexcept>
#include <string>

namespace springtower {
namespace {

constexpr int kShadowSize = 2048;
constexpr int kSmallShadowSize = 1024;
const Vec3 kToLight = Vec3(-0.2, -0.8, 0.75).normalized();  // from the left of the default camera
const Vec3 kBackground = {0.965, 0.96, 0.955};

GLuint compiled(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE) return shader;
  std::string log(2000, '\0');
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw std::runtime_error("a shader does not compile: " + std::string(log.c_str()));
}

GLuint linked(const char* fragment) {
  const GLuint program = glCreateProgram();
  const GLuint shaders[] = {compiled(GL_VERTEX_SHADER, kVertexShader), compiled(GL_FRAGMENT_SHADER, fragment)};
  for (const GLuint shader : shaders) glAttachShader(program, shader);
  glLinkProgram(program);
  for (const GLuint shader : shaders) glDeleteShader(shader);
  GLint good = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (good == GL_TRUE) return program;
  throw std::runtime_error("the shaders do not link");
}

// OpenGL takes the offset in a buffer as a pointer.
const void* asPointer(std::size_t offset) {
  return std::bit_cast<const void*>(offset);
}

void attribute(GLuint at, GLint count, std::size_t offset) {
  glEnableVertexAttribArray(at);
  glVertexAttribPointer(at, count, GL_FLOAT, GL_FALSE, sizeof(Vertex), asPointer(offset));
}

void setMatrix(GLuint program, const char* name, const Eigen::Matrix4f& matrix) {
  glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, matrix.data());
}

void setVector(GLuint program, const char* name, const Vec3& vector) {
  const Eigen::Vector3f v = vector.cast<float>();
  glUniform3f(glGetUniformLocation(program, name), v.x(), v.y(), v.z());
}

// A ball around all vertices.
struct Ball {
  Vec3 middle = Vec3::Zero();
  double radius = 0.1;
};
Ball ballAround(std::span<const Vertex> vertices) {
  if (vertices.empty()) return {};
  Eigen::Vector3f low = Eigen::Vector3f::Map(vertices[0].position.data());
  Eigen::Vector3f high = low;
  for (const Vertex& vertex : vertices) {
    const Eigen::Vector3f at = Eigen::Vector3f::Map(vertex.position.data());
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  return {(0.5F * (low + high)).cast<double>(), 0.5 * static_cast<double>((high - low).norm()) + 0.005};
}

// Straight-down-the-light projection of the ball, whose depth is what the shadow map keeps.
Eigen::Matrix4f lightMatrix(const Ball& ball) {
  const Vec3 back = kToLight;
  const Vec3 right = Vec3::UnitZ().cross(back).normalized();
  const Vec3 up = back.cross(right);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.block<1, 3>(0, 0) = right.transpose() / ball.radius;
  matrix.block<1, 3>(1, 0) = up.transpose() / ball.radius;
  matrix.block<1, 3>(2, 0) = -back.transpose() / ball.radius;
  matrix.block<3, 1>(0, 3) = -matrix.block<3, 3>(0, 0) * ball.middle;
  return matrix.cast<float>();
}

std::vector<Vertex> floorMesh(const Ball& ball, double radius) {
  const auto x = static_cast<float>(ball.middle.x());
  const auto y = static_cast<float>(ball.middle.y());
  const auto r = static_cast<float>(radius);
  std::vector<Vertex> mesh;
  for (const auto& [dx, dy] : {std::pair{-r, -r}, {r, -r}, {r, r}, {-r, -r}, {r, r}, {-r, r}}) {
    Vertex vertex{};
    vertex.position = {x + dx, y + dy, 0.0F};
    vertex.normal = {0.0F, 0.0F, 1.0F};
    vertex.block = -1;
    mesh.push_back(vertex);
  }
  return mesh;
}

}  // namespace

bool drawsInSoftware() {
  const auto* text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string name = text == nullptr ? "" : text;
  return name.find("llvmpipe") != std::string::npos || name.find("softpipe") != std::string::npos;
}

Renderer::Renderer() : shadowSize_(drawsInSoftware() ? kSmallShadowSize : kShadowSize) {
  shade_ = linked(kShadeShader);
  plain_ = linked(kPlainShader);
  number_ = linked(kNumberShader);
  glGenVertexArrays(1, &vertexArray_);
  glGenBuffers(1, &vertexBuffer_);
  glBindVertexArray(vertexArray_);
  glBindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 2, offsetof(Vertex, inFace));
  attribute(3, 2, offsetof(Vertex, half));
  attribute(4, 3, offsetof(Vertex, colour));
  glEnableVertexAttribArray(5);
  glVertexAttribIPointer(5, 1, GL_INT, sizeof(Vertex), asPointer(offsetof(Vertex, block)));

  glGenTextures(1, &shadowMap_);
  glBindTexture(GL_TEXTURE_2D, shadowMap_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, shadowSize_, shadowSize_, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glGenFramebuffers(1, &shadowFrame_);
  GLint bound = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &bound);
  glBindFramebuffer(GL_FRAMEBUFFER, shadowFrame_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadowMap_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

Renderer::~Renderer() {
  glDeleteFramebuffers(1, &shadowFrame_);
  glDeleteTextures(1, &shadowMap_);
  glDeleteBuffers(1, &vertexBuffer_);
  glDeleteVertexArrays(1, &vertexArray_);
  for (const GLuint program : {shade_, plain_, number_}) glDeleteProgram(program);
}

void Renderer::upload(std::span<const Vertex> vertices) {
  glBindVertexArray(vertexArray_);
  glBindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(), GL_STREAM_DRAW);
}

void Renderer::drawShadows(const Picture& picture, const Eigen::Matrix4f& lightFromWorld) {
  GLint bound = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &bound);
  glBindFramebuffer(GL_FRAMEBUFFER, shadowFrame_);
  glViewport(0, 0, shadowSize_, shadowSize_);
  glClear(GL_DEPTH_BUFFER_BIT);
  glUseProgram(plain_);
  setMatrix(plain_, "clipFromWorld", lightFromWorld);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(picture.blocks.size()));
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

void Renderer::draw(const Picture& picture, const Camera& camera, const Viewport& viewport) {
  const Ball ball = ballAround(picture.blocks);
  const Eigen::Matrix4f light = lightMatrix(ball);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_MULTISAMPLE);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  upload(picture.blocks);
  drawShadows(picture, light);

  glViewport(0, 0, viewport.width, viewport.height);
  glClearColor(static_cast<float>(kBackground.x()), static_cast<float>(kBackground.y()), static_cast<float>(kBackground.z()),
               1.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const Eigen::Matrix4f clip = clipFromWorld(camera, viewport);
  const double floorRadius = std::max(2.0, 3.0 * ball.radius);
  glUseProgram(shade_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, shadowMap_);
  glUniform1i(glGetUniformLocation(shade_, "shadow"), 0);
  setMatrix(shade_, "clipFromWorld", clip);
  setMatrix(shade_, "lightFromWorld", light);
  setVector(shade_, "toLight", kToLight);
  setVector(shade_, "background", kBackground);
  setVector(shade_, "eye", cameraFrame(camera).eye);
  glUniform1i(glGetUniformLocation(shade_, "highlighted"), picture.highlighted);
  glUniform2f(glGetUniformLocation(shade_, "floorMiddle"), static_cast<float>(ball.middle.x()),
              static_cast<float>(ball.middle.y()));
  glUniform1f(glGetUniformLocation(shade_, "floorRadius"), static_cast<float>(floorRadius));
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(picture.blocks.size()));
  if (picture.floor) {
    const std::vector<Vertex> floor = floorMesh(ball, floorRadius);
    upload(floor);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(floor.size()));
  }
  glUseProgram(plain_);
  setMatrix(plain_, "clipFromWorld", clip);
  if (!picture.ground.empty()) {
    upload(picture.ground);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(picture.ground.size()));
  }
  if (picture.marks.empty()) return;
  upload(picture.marks);
  glDisable(GL_DEPTH_TEST);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(picture.marks.size()));
  glEnable(GL_DEPTH_TEST);
}

std::vector<std::int32_t> Renderer::blocksSeen(const Picture& picture, const Camera& camera, const Viewport& viewport) {
  GLint bound = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &bound);
  GLuint frame = 0;
  GLuint buffers[2] = {0, 0};
  glGenFramebuffers(1, &frame);
  glGenRenderbuffers(2, buffers);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_R32I, viewport.width, viewport.height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[0]);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, viewport.width, viewport.height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers[1]);

  glViewport(0, 0, viewport.width, viewport.height);
  glEnable(GL_DEPTH_TEST);
  const GLint none[4] = {-1, -1, -1, -1};
  glClearBufferiv(GL_COLOR, 0, none);
  glClear(GL_DEPTH_BUFFER_BIT);
  upload(picture.blocks);
  glUseProgram(number_);
  setMatrix(number_, "clipFromWorld", clipFromWorld(camera, viewport));
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(picture.blocks.size()));
  std::vector<std::int32_t> seen(static_cast<std::size_t>(viewport.width) * static_cast<std::size_t>(viewport.height));
  glReadPixels(0, 0, viewport.width, viewport.height, GL_RED_INTEGER, GL_INT, seen.data());
  for (int low = 0, high = viewport.height - 1; low < high; ++low, --high) {
    std::swap_ranges(seen.begin() + static_cast<std::ptrdiff_t>(low) * viewport.width,
                     seen.begin() + static_cast<std::ptrdiff_t>(low + 1) * viewport.width,
                     seen.begin() + static_cast<std::ptrdiff_t>(high) * viewport.width);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
  glDeleteRenderbuffers(2, buffers);
  glDeleteFramebuffers(1, &frame);
  return seen;
}

Image Renderer::read(const Viewport& viewport) {
  Image image{viewport.width, viewport.height, {}};
  const std::size_t stride = 3 * static_cast<std::size_t>(viewport.width);
  std::vector<std::uint8_t> flipped(stride * static_cast<std::size_t>(viewport.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, viewport.width, viewport.height, GL_RGB, GL_UNSIGNED_BYTE, flipped.data());
  image.rgb.reserve(flipped.size());
  for (std::size_t row = static_cast<std::size_t>(viewport.height); row-- > 0;) {
    const auto first = flipped.begin() + static_cast<std::ptrdiff_t>(row * stride);
    image.rgb.insert(image.rgb.end(), first, first + static_cast<std::ptrdiff_t>(stride));
  }
  return image;
}

}  // namespace springtower
