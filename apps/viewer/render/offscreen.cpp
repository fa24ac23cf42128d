// The part of render.h that needs no window.
#include "apps/viewer/render/render.h"

#include <algorithm>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdexcept>

namespace springtower {
namespace {

constexpr GLint kSamples = 4;

// EGL without a window system comes first: it needs no display and no rights.
EGLDisplay openedDisplay() {
  const EGLDisplay candidates[] = {epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")
                                       ? eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)
                                       : EGL_NO_DISPLAY,
                                   eglGetDisplay(EGL_DEFAULT_DISPLAY)};
  for (const EGLDisplay display : candidates) {
    if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) return display;
  }
  throw std::runtime_error("no EGL display: install libegl1 and libgl1-mesa-dri");
}

}  // namespace

OffscreenContext::OffscreenContext() {
  display_ = openedDisplay();
  eglBindAPI(EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  eglChooseConfig(display_, wanted, &config, 1, &count);
  const EGLint version[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  if (count > 0) context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version);
  if (context_ == nullptr || eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
    throw std::runtime_error("EGL gives no OpenGL 3.3 context without a window");
  }
}

OffscreenContext::~OffscreenContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  // The display stays until the program ends: what a driver keeps in its own variables would count as lost memory once the driver
  // is unloaded, and hide what we lose.
}

OffscreenFrame::OffscreenFrame(const Viewport& viewport) : viewport_(viewport) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  glGenFramebuffers(2, frames_);
  glGenRenderbuffers(3, buffers_);
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
  const GLenum formats[] = {GL_RGBA8, GL_DEPTH_COMPONENT24};
  const GLenum places[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
  for (std::size_t i = 0; i < 2; ++i) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffers_[i]);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, std::min(kSamples, most), formats[i], viewport.width, viewport.height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, buffers_[i]);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[1]);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers_[2]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, viewport.width, viewport.height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[2]);
  bind();
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("the driver gives no framebuffer of this size");
  }
}

OffscreenFrame::~OffscreenFrame() {
  glDeleteRenderbuffers(3, buffers_);
  glDeleteFramebuffers(2, frames_);
}

void OffscreenFrame::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
}

Image OffscreenFrame::read() const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[0]);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, frames_[1]);
  glBlitFramebuffer(0, 0, viewport_.width, viewport_.height, 0, 0, viewport_.width, viewport_.height, GL_COLOR_BUFFER_BIT,
                    GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, frames_[1]);
  Image image = Renderer::read(viewport_);
  bind();
  return image;
}

}  // namespace springtower
