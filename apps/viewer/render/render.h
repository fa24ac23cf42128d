#pragma once

#include "apps/viewer/input/camera.h"
#include "apps/viewer/view/picture.h"

#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// An image, rows from the top, 8 bits each of red, green and blue.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Whether the current context draws on the processor: pictures are then made cheaper.
bool drawsInSoftware();

/// Draws with OpenGL 3.3 core into the framebuffer that is bound. A context has to be current for its whole life.
class Renderer {
 public:
  /// Compiles the shaders. Throws std::runtime_error with the driver's message.
  Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  ~Renderer();

  /// Draws a picture: a shadow map first, then blocks, floor and marks.
  void draw(const Picture& picture, const Camera& camera, const Viewport& viewport);

  /// Which block is seen at each pixel, rows from the top, -1 for none; drawn apart and read back.
  std::vector<std::int32_t> blocksSeen(const Picture& picture, const Camera& camera, const Viewport& viewport);

  /// What the bound framebuffer shows.
  static Image read(const Viewport& viewport);

 private:
  void upload(std::span<const Vertex> vertices);
  void drawShadows(const Picture& picture, const Eigen::Matrix4f& lightFromWorld);
  void uploadNearby(const Picture& picture);
  void drawBlocks(const Picture& picture, const Camera& camera, const Eigen::Matrix4f& clip, const Eigen::Matrix4f& light);
  void drawFloor(const Picture& picture, const Camera& camera, const Eigen::Matrix4f& clip, const Eigen::Matrix4f& light);

  int shadowSize_;      // pixels a side; less where a processor draws
  unsigned block_ = 0;  // programs
  unsigned floor_ = 0;
  unsigned plain_ = 0;
  unsigned number_ = 0;
  unsigned vertexArray_ = 0;
  unsigned vertexBuffer_ = 0;
  unsigned shadowMap_ = 0;
  unsigned floorOpen_ = 0;
  unsigned nearbyBuffers_[2] = {0, 0};  // boxes, and which are near which
  unsigned nearbyTextures_[2] = {0, 0};
  unsigned shadowFrame_ = 0;
};

/// A framebuffer without a window, with four samples a pixel where the driver has them.
class OffscreenFrame {
 public:
  explicit OffscreenFrame(const Viewport& viewport);
  OffscreenFrame(const OffscreenFrame&) = delete;
  OffscreenFrame& operator=(const OffscreenFrame&) = delete;
  ~OffscreenFrame();
  /// Makes it the target of drawing.
  void bind() const;
  /// What has been drawn, its samples averaged.
  [[nodiscard]] Image read() const;

 private:
  Viewport viewport_;
  unsigned frames_[2] = {0, 0};  // drawn into, and read from
  unsigned buffers_[3] = {0, 0, 0};
};

/// An OpenGL 3.3 core context without a window, through EGL: without any display where the driver can (Mesa), else on the default
/// one. Throws std::runtime_error when there is none.
class OffscreenContext {
 public:
  OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;
  ~OffscreenContext();

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace springtower
