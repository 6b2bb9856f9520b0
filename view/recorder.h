/* Pictures as they are drawn, into a video or a folder. */
#ifndef PBF_VIEW_RECORDER_H
#define PBF_VIEW_RECORDER_H

#include <sys/types.h>

#include <string>
#include <vector>

namespace view {

inline constexpr double film_rate = 60;  // pictures a second

class Recorder {
 public:
  // A path with an ending, as water.mp4, is a video, which ffmpeg writes, at `rate` pictures a
  // second; any other is a folder, which gets 000000.png, 000001.png, … Throws bench::Error.
  Recorder(const std::string &path, int width, int height, double rate);
  ~Recorder();
  Recorder(const Recorder &) = delete;
  Recorder &operator=(const Recorder &) = delete;

  // Rows from above, three bytes a pixel.
  void add(const std::vector<unsigned char> &rgb);

  void finish();  // throws where the video is not good

 private:
  std::string path_;
  int width_, height_;
  unsigned pictures_ = 0;
  int pipe_ = -1;  // to ffmpeg
  pid_t child_ = -1;
};

}  // namespace view

#endif
