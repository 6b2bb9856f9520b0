/* OpenGL without a display: a context of EGL that has no surface, and a frame buffer of its own. */
#ifndef PBF_VIEW_OFFSCREEN_H
#define PBF_VIEW_OFFSCREEN_H

#include <epoxy/gl.h>

#include <vector>

namespace view {

class Offscreen {
 public:
  // `finer`: so many pixels a side are drawn for one of the picture. Throws bench::Error.
  Offscreen(int width, int height, int finer);
  ~Offscreen();
  Offscreen(const Offscreen &) = delete;
  Offscreen &operator=(const Offscreen &) = delete;

  int width() const { return width_ * finer_; }
  int height() const { return height_ * finer_; }

  // The picture: rows from above, three bytes a pixel.
  std::vector<unsigned char> pixels() const;

 private:
  int width_, height_, finer_;
  void *display_, *context_;
  GLuint buffers_[2], textures_[3];
};

}  // namespace view

#endif
