#include "apps/viewer/io/output.h"

#include "apps/common/output_file.h"
#include "core/error.h"
#include "core/limits.h"

#include <cairo.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <ostream>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace springtower {
namespace {

cairo_status_t toStream(void* stream, const unsigned char* data, unsigned int length) {
  auto& out = *static_cast<std::ostream*>(stream);
  out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(length));
  return out ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

std::string findProgram(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string program = fmt::format("{}/{}", folder, name);
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  return {};
}

// The name of a film, where one can be made. Throws InputError.
const std::string& checkedFilm(const std::string& path) {
  if (!path.ends_with(".mp4") && !path.ends_with(".gif")) {
    throw InputError(fmt::format("--video: expected a name that ends with .mp4 or .gif, got {}", inQuotes(path)));
  }
  if (findProgram("ffmpeg").empty())
    throw InputError("--video: expected ffmpeg to be installed, got none; apt-get install ffmpeg");
  return path;
}

}  // namespace

void writePng(const std::string& path, const std::string& option, const Image& image) {
  OutputFile file(path, option);
  std::vector<std::uint32_t> pixels;
  pixels.reserve(image.rgb.size() / 3);
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    const std::uint32_t red = image.rgb[i];
    const std::uint32_t green = image.rgb[i + 1];
    pixels.push_back(0xff000000U | (red << 16U) | (green << 8U) | image.rgb[i + 2]);
  }
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(pixels.data()), CAIRO_FORMAT_RGB24, image.width,
                                          image.height, 4 * image.width),
      cairo_surface_destroy);
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), toStream, &file.stream());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw InputError(fmt::format("{}: expected a file that can be written, got {}: {}", option, inQuotes(path),
                                 cairo_status_to_string(status)));
  }
  file.commit();
}

void writeBlocksSeen(const std::string& path, const std::string& option, std::span<const std::int32_t> seen,
                     const Viewport& viewport) {
  OutputFile file(path, option);
  file.stream() << "P5\n" << viewport.width << ' ' << viewport.height << "\n65535\n";
  for (const std::int32_t block : seen) {
    const auto value = static_cast<unsigned>(block + 1);
    file.stream().put(static_cast<char>((value >> 8U) & 0xffU)).put(static_cast<char>(value & 0xffU));
  }
  file.commit();
}

bool ffmpegInstalled() {
  return !findProgram("ffmpeg").empty();
}

Film::Film(const std::string& path, const Viewport& viewport, int framesPerSecond)
    : file_(checkedFilm(path), "--video"), path_(path), viewport_(viewport) {
  const std::string program = findProgram("ffmpeg");
  const std::string size = fmt::format("{}x{}", viewport.width, viewport.height);
  const std::string rate = std::to_string(framesPerSecond);
  // A GIF takes at most 50 pictures a second and needs a palette of its own; most players of MP4 need even sizes.
  const std::string filter = path.ends_with(".gif") ? "fps=25,split[a][b];[a]palettegen[p];[b][p]paletteuse"
                                                    : "scale=trunc(iw/2)*2:trunc(ih/2)*2,format=yuv420p";
  const std::string format = path.ends_with(".gif") ? "gif" : "mp4";
  std::vector<std::string> words = {
      "ffmpeg", "-loglevel", "error", "-y",   "-f", "rawvideo", "-pix_fmt",         "rgb24", "-s", size, "-r", rate,
      "-i",     "-",         "-vf",   filter, "-f", format,     file_.writtenPath()};
  if (words.back().starts_with('-')) words.back() = "./" + words.back();  // not an option
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw InputError(std::string("--video: no pipe: ") + std::strerror(errno));
  process_ = fork();
  if (process_ == 0) {
    setpgid(0, 0);  // the terminal's Ctrl-C is answered here, and the film ends with its last picture
    dup2(ends[0], STDIN_FILENO);
    execv(program.c_str(), arguments.data());
    _exit(127);
  }
  close(ends[0]);
  pipe_ = fdopen(ends[1], "wb");
}

Film::~Film() {
  if (pipe_ != nullptr) std::fclose(pipe_);
  if (process_ > 0) waitpid(process_, nullptr, 0);
}

void Film::add(const Image& image) {
  if (pipe_ == nullptr || image.width != viewport_.width || image.height != viewport_.height) return;
  std::fwrite(image.rgb.data(), 1, image.rgb.size(), pipe_);
}

void Film::finish() {
  if (pipe_ != nullptr) std::fclose(pipe_);
  pipe_ = nullptr;
  int status = -1;
  if (process_ > 0) waitpid(process_, &status, 0);
  process_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw InputError(fmt::format("--video: expected a video of {} by ffmpeg, got its exit code {}", inQuotes(path_),
                                 WIFEXITED(status) ? WEXITSTATUS(status) : -1));
  }
  file_.commit();
}

}  // namespace springtower
