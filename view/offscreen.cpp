#include "offscreen.h"

#include <epoxy/egl.h>

#include "core/error.h"
#include "pixels.h"

namespace view {
namespace {

[[noreturn]] void fail(const char *what) {
  throw bench::Error(bench::exit_unavailable,
                     std::string("OpenGL 3.3 can't be had without a display: ") + what +
                         " (Mesa's software renderer is Debian's libgl1-mesa-dri)");
}

EGLDisplay open_display() {
  EGLDisplay display = EGL_NO_DISPLAY;
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY) display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr))
    fail("EGL has no display");
  return display;
}

EGLContext make_context(EGLDisplay display) {
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                            3,
                            EGL_CONTEXT_MINOR_VERSION,
                            3,
                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                            EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglBindAPI(EGL_OPENGL_API) || !eglChooseConfig(display, wanted, &config, 1, &count) ||
      count == 0)
    fail("EGL has no configuration for it");
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
  if (context == EGL_NO_CONTEXT ||
      !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
    fail("EGL makes no such context");
  return context;
}

void attach_texture(GLuint texture, int width, int height) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
}

}  // namespace

Offscreen::Offscreen(int width, int height, int finer)
    : width_(width),
      height_(height),
      finer_(finer),
      display_(open_display()),
      context_(make_context(display_)) {
  glGenFramebuffers(2, buffers_);
  glGenTextures(3, textures_);
  glBindFramebuffer(GL_FRAMEBUFFER, buffers_[1]);  // the picture
  attach_texture(textures_[2], width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, buffers_[0]);  // what is drawn into
  attach_texture(textures_[0], width * finer, height * finer);
  glBindTexture(GL_TEXTURE_2D, textures_[1]);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, width * finer, height * finer, 0,
               GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, textures_[1], 0);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    fail("its frame buffer is incomplete");
}

Offscreen::~Offscreen() {
  glDeleteFramebuffers(2, buffers_);
  glDeleteTextures(3, textures_);
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

std::vector<unsigned char> Offscreen::pixels() const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, buffers_[1]);
  // Linear at half the size is the mean of four.
  glBlitFramebuffer(0, 0, width(), height(), 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_LINEAR);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, buffers_[1]);
  std::vector<unsigned char> rows = read_pixels(width_, height_);
  glBindFramebuffer(GL_FRAMEBUFFER, buffers_[0]);
  return rows;
}

}  // namespace view
