#pragma once

#include "apps/viewer/render/render.h"
#include "core/output_file.h"

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

namespace springtower {

/// Writes an image as a PNG. Throws InputError naming the option and the file when it cannot be written.
void writePng(const std::string& path, const std::string& option, const Image& image);

/// Writes which block is seen at each pixel as a PGM of 16 bits: 0 for none, else the block's number plus one. Throws InputError.
void writeBlocksSeen(const std::string& path, const std::string& option, std::span<const std::int32_t> seen,
                     const Viewport& viewport);

/// Whether the program ffmpeg is installed.
bool ffmpegInstalled();

/// A video that ffmpeg makes of images of one size: MP4 or GIF, by the name's ending. It has its name when it is finished, as any
/// OutputFile.
class Film {
 public:
  /// Starts ffmpeg. Throws InputError when it is not installed or the name has another ending.
  Film(const std::string& path, const Viewport& viewport, int framesPerSecond);
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  ~Film();
  /// Adds an image; one of another size is left out.
  void add(const Image& image);
  /// Waits until the video is complete. Throws InputError when ffmpeg failed.
  void finish();

 private:
  OutputFile file_;  // locks the name; ffmpeg writes it
  std::string path_;
  Viewport viewport_;
  std::FILE* pipe_ = nullptr;
  int process_ = -1;
};

}  // namespace springtower
