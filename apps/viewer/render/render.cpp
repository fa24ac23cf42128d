#include "apps/viewer/render/render.h"

#include "apps/common/look.h"
#include "apps/viewer/render/shaders.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <epoxy/gl.h>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>

namespace springtower {
namespace {

constexpr int kShadowSize = 2048;
constexpr int kSmallShadowSize = 1024;
const Vec3 kGridBackground = {0.965, 0.96, 0.955};
constexpr double kTableHeight_m = 0.028;
constexpr int kRimParts = 96;

// Where the sun stands: as in `run --picture`, for the camera as it opens.
Vec3 towardsSun() {
  const CameraFrame frame = cameraFrame({});
  return (look::kSun[0] * frame.back + look::kSun[1] * frame.right + look::kSun[2] * Vec3::UnitZ()).normalized();
}

Vec3 vectorOf(const look::Rgb& colour) {
  return {colour[0], colour[1], colour[2]};
}

GLuint compiled(GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE) return shader;
  std::string log(2000, '\0');
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw std::runtime_error("a shader does not compile: " + std::string(log.c_str()));
}

GLuint linked(const std::string& fragment) {
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
  const Vec3 back = towardsSun();
  const Vec3 right = Vec3::UnitZ().cross(back).normalized();
  const Vec3 up = back.cross(right);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.block<1, 3>(0, 0) = right.transpose() / ball.radius;
  matrix.block<1, 3>(1, 0) = up.transpose() / ball.radius;
  matrix.block<1, 3>(2, 0) = -back.transpose() / ball.radius;
  matrix.block<3, 1>(0, 3) = -matrix.block<3, 3>(0, 0) * ball.middle;
  return matrix.cast<float>();
}

Vertex floorVertex(const Vec3& at, const Vec3& normal) {
  Vertex vertex{};
  for (std::size_t a = 0; a < 3; ++a) {
    vertex.position[a] = static_cast<float>(at[static_cast<Eigen::Index>(a)]);
    vertex.normal[a] = static_cast<float>(normal[static_cast<Eigen::Index>(a)]);
  }
  vertex.block = -1;
  return vertex;
}

// A square for the grid; else a round table with its rim.
std::vector<Vertex> floorMesh(const Vec3& middle, double radius, bool square) {
  std::vector<Vertex> mesh;
  const Vec3 up = Vec3::UnitZ();
  if (square) {
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}})
      mesh.push_back(floorVertex(middle + radius * Vec3(x, y, 0.0), up));
    return mesh;
  }
  const auto out = [](int part) {
    const double angle = 2.0 * std::numbers::pi * part / kRimParts;
    return Vec3(std::cos(angle), std::sin(angle), 0.0);
  };
  const Vec3 down = -kTableHeight_m * up;
  for (int i = 0; i < kRimParts; ++i) {
    const Vec3 a = out(i);
    const Vec3 b = out(i + 1);
    for (const Vec3& at : {Vec3(middle), Vec3(middle + radius * a), Vec3(middle + radius * b)})
      mesh.push_back(floorVertex(at, up));
    const Vec3 rim[] = {middle + radius * a, middle + radius * a + down, middle + radius * b + down, middle + radius * b};
    for (const int corner : {0, 1, 2, 0, 2, 3}) mesh.push_back(floorVertex(rim[corner], corner == 0 || corner == 1 ? a : b));
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
  const std::string common = kCommonShader;
  std::string blocks = common + kBlockShader;
  constexpr std::string_view kPlace = "ENDGRAIN";
  blocks.replace(blocks.find(kPlace), kPlace.size(), std::to_string(look::kEndGrain));
  block_ = linked(blocks);
  floor_ = linked(common + kFloorShader);
  plain_ = linked(kPlainShader);
  number_ = linked(kNumberShader);
  glGenVertexArrays(1, &vertexArray_);
  glGenBuffers(1, &vertexBuffer_);
  glBindVertexArray(vertexArray_);
  glBindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 3, offsetof(Vertex, local));
  attribute(3, 3, offsetof(Vertex, colour));
  glEnableVertexAttribArray(4);
  glVertexAttribIPointer(4, 1, GL_INT, sizeof(Vertex), asPointer(offsetof(Vertex, block)));

  glGenBuffers(2, nearbyBuffers_);
  glGenTextures(2, nearbyTextures_);
  glGenTextures(1, &floorOpen_);
  glBindTexture(GL_TEXTURE_2D, floorOpen_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
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
  glDeleteTextures(1, &floorOpen_);
  glDeleteTextures(2, nearbyTextures_);
  glDeleteBuffers(2, nearbyBuffers_);
  glDeleteBuffers(1, &vertexBuffer_);
  glDeleteVertexArrays(1, &vertexArray_);
  for (const GLuint program : {block_, floor_, plain_, number_}) glDeleteProgram(program);
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

void Renderer::uploadNearby(const Picture& picture) {
  const auto fill = [&](std::size_t i, GLenum format, const void* data, std::size_t bytes) {
    glBindBuffer(GL_TEXTURE_BUFFER, nearbyBuffers_[i]);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_STREAM_DRAW);
    glActiveTexture(static_cast<GLenum>(GL_TEXTURE1 + i));
    glBindTexture(GL_TEXTURE_BUFFER, nearbyTextures_[i]);
    glTexBuffer(GL_TEXTURE_BUFFER, format, nearbyBuffers_[i]);
  };
  fill(0, GL_RGBA32F, picture.nearby.boxes.data(), picture.nearby.boxes.size() * sizeof(picture.nearby.boxes[0]));
  fill(1, GL_R32I, picture.nearby.near.data(), picture.nearby.near.size() * sizeof(picture.nearby.near[0]));
  glActiveTexture(GL_TEXTURE0);
}

namespace {

void setLight(GLuint program, const Picture& picture, const Camera& camera, const Eigen::Matrix4f& clip,
              const Eigen::Matrix4f& light) {
  glUseProgram(program);
  glUniform1i(glGetUniformLocation(program, "shadow"), 0);
  setMatrix(program, "clipFromWorld", clip);
  setMatrix(program, "lightFromWorld", light);
  setVector(program, "toLight", towardsSun());
  setVector(program, "background", picture.grid ? kGridBackground : vectorOf(look::kBackdrop));
  setVector(program, "eye", cameraFrame(camera).eye);
}

}  // namespace

void Renderer::drawBlocks(const Picture& picture, const Camera& camera, const Eigen::Matrix4f& clip,
                          const Eigen::Matrix4f& light) {
  uploadNearby(picture);
  upload(picture.blocks);
  setLight(block_, picture, camera, clip, light);
  glUniform1i(glGetUniformLocation(block_, "boxes"), 1);
  glUniform1i(glGetUniformLocation(block_, "nearby"), 2);
  glUniform1i(glGetUniformLocation(block_, "highlighted"), picture.highlighted);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(picture.blocks.size()));
}

void Renderer::drawFloor(const Picture& picture, const Camera& camera, const Eigen::Matrix4f& clip,
                         const Eigen::Matrix4f& light) {
  constexpr double kGridRadius_m = 2.0;
  constexpr auto kCells = static_cast<GLsizei>(FloorOpenness::kCells);
  const FloorOpenness& open = picture.floorOpen;
  const double radius = picture.grid ? std::max(kGridRadius_m, 2.0 * picture.tableRadius) : picture.tableRadius;
  const std::vector<Vertex> floor = floorMesh(picture.table, radius, picture.grid);
  upload(floor);
  setLight(floor_, picture, camera, clip, light);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, floorOpen_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, kCells, kCells, 0, GL_RED, GL_UNSIGNED_BYTE, open.open.data());
  glActiveTexture(GL_TEXTURE0);
  glUniform1i(glGetUniformLocation(floor_, "floorOpen"), 1);
  glUniform3f(glGetUniformLocation(floor_, "floorOpenPlace"), open.corner[0], open.corner[1], open.side);
  glUniform2f(glGetUniformLocation(floor_, "floorMiddle"), static_cast<float>(picture.table.x()),
              static_cast<float>(picture.table.y()));
  glUniform1f(glGetUniformLocation(floor_, "floorRadius"), static_cast<float>(radius));
  glUniform1i(glGetUniformLocation(floor_, "grid"), picture.grid ? 1 : 0);
  setVector(floor_, "table", vectorOf(look::kTable));
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(floor.size()));
}

void Renderer::draw(const Picture& picture, const Camera& camera, const Viewport& viewport) {
  const Eigen::Matrix4f light = lightMatrix(ballAround(picture.blocks));
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_MULTISAMPLE);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  upload(picture.blocks);
  drawShadows(picture, light);

  glViewport(0, 0, viewport.width, viewport.height);
  const Eigen::Vector3f background = (picture.grid ? kGridBackground : vectorOf(look::kBackdrop)).cast<float>();
  glClearColor(background.x(), background.y(), background.z(), 1.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const Eigen::Matrix4f clip = clipFromWorld(camera, viewport);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, shadowMap_);
  drawBlocks(picture, camera, clip, light);
  if (picture.floor) drawFloor(picture, camera, clip, light);
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
