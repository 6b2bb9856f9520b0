/* Dear ImGui over the picture. */
#ifndef PBF_VIEW_INTERFACE_H
#define PBF_VIEW_INTERFACE_H

#include "options.h"
#include "panel.h"

struct GLFWwindow;

namespace view {

class Interface {
 public:
  explicit Interface(GLFWwindow *window);       // which it hears keys and the mouse of
  Interface(int width, int height, int finer);  // without a window
  ~Interface();
  Interface(const Interface &) = delete;
  Interface &operator=(const Interface &) = delete;

  void begin();
  void end();  // draws what has been asked for in between

 private:
  void open();
  bool windowed_;
};

Controls controls_of(const Options &options, const Simulation &simulation);

}  // namespace view

#endif
