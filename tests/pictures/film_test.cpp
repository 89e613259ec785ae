// Films: frames, a picture of the end, ffmpeg, and what is wrong with a request.
#include "spikeloop/pictures/film.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <optional>

#include "spikeloop/core/error.hpp"
#include "tests/support/child.hpp"
#include "tests/support/fault.hpp"
#include "worlds.hpp"

namespace spikeloop::pictures {
namespace {

using test::Fault;

class FilmTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (directory_.path() / name).string(); }

  /// One and a half seconds of driving ahead, along x.
  void drive(Film& film, vehicle::Vehicle& vehicle) {
    vehicle.command(1.0, 0);
    film.take(vehicle);
    for (int i = 0; i < 150; ++i) {
      vehicle.step(10 * kMs);
      film.take(vehicle);
    }
    film.finish(vehicle);
  }

  World world_{""};
  test::TemporaryDirectory directory_;
};

std::size_t red_pixels(const Image& image) {
  std::size_t count = 0;
  for (std::uint32_t row = 0; row < image.size.height; ++row) {
    count += columns_of(image, 0, row).size();
  }
  return count;
}

TEST_F(FilmTest, FramesAreWhatTheRateSays) {
  vehicle::Vehicle vehicle = world_.vehicle();
  Film film(vehicle, {.path = path("frames"), .size = {160, 120}, .rate_hz = 20});
  EXPECT_EQ(film.next(), 0);
  drive(film, vehicle);
  EXPECT_EQ(film.next(), 1550 * kMs);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path("frames"))) {
    names.push_back(entry.path().filename());
  }
  std::ranges::sort(names);
  ASSERT_EQ(names.size(), 31U) << "at 0, 50, ..., 1500 ms";
  EXPECT_EQ(names.front(), "frame_000001.png");
  EXPECT_EQ(names.back(), "frame_000031.png");
  const Image first = read_png(path("frames/frame_000001.png"));
  const Image last = read_png(path("frames/frame_000031.png"));
  EXPECT_EQ(first.size, (Size{160, 120}));
  EXPECT_EQ(red_pixels(first), 0U) << "no path yet";
  EXPECT_GT(red_pixels(last), 5U) << "the path";
}

TEST_F(FilmTest, ThePictureOfTheEndShowsThePath) {
  vehicle::Vehicle vehicle = world_.vehicle();
  Film film(vehicle, {.path = path("end.png"), .size = {320, 240}});
  drive(film, vehicle);
  const Image image = read_png(path("end.png"));
  EXPECT_EQ(image.size, (Size{320, 240}));
  EXPECT_GT(red_pixels(image), 20U);
}

TEST_F(FilmTest, ViewsStandSideBySide) {
  vehicle::Vehicle vehicle =
      World("<geom type=\"box\" size=\"0.1 3 1\" pos=\"1 0 1\" rgba=\"0 1 0 1\"/>").vehicle();
  Film film(
      vehicle,
      {.path = path("end.png"), .views = views_named("above+chase+camera"), .size = {300, 100}});
  film.take(vehicle);
  film.finish(vehicle);
  const Image image = read_png(path("end.png"));
  EXPECT_EQ(columns_of(image, 1, 30).back(), 299U);
  const auto green = columns_of(image, 1, 30);
  EXPECT_GE(std::ranges::count_if(green, [](auto column) { return column >= 200; }), 100)
      << "the camera sees nothing but the wall there";
  const auto blue = columns_of(image, 2, 60);
  EXPECT_TRUE(std::ranges::any_of(blue, [](auto column) { return column > 100 && column < 200; }))
      << "from behind, the vehicle is in the middle";
}

TEST_F(FilmTest, FfmpegMakesFilms) {
  for (const char* name : {"film.mp4", "film.gif", "film.webm", "film.mkv"}) {
    vehicle::Vehicle vehicle = world_.vehicle();
    {
      Film film(vehicle, {.path = path(name), .size = {161, 120}, .rate_hz = 10});
      drive(film, vehicle);
    }
    const auto probe =
        test::Child({.arguments = {"ffprobe", "-v", "error", "-count_frames", "-show_entries",
                                   "stream=nb_read_frames", "-of", "csv=p=0", path(name)}})
            .wait();
    EXPECT_THAT(probe.out, testing::StartsWith("16")) << name << ": " << probe.text();
  }
}

TEST_F(FilmTest, FilmingChangesNothing) {
  const auto course = [this](bool film_it, const char* name) {
    vehicle::Vehicle vehicle({"arena", 3});
    std::optional<Film> film;
    if (film_it) {
      film.emplace(vehicle, FilmOptions{.path = path(name), .size = {64, 48}, .rate_hz = 5});
    }
    vehicle.command(0.7, -0.6);
    for (int i = 0; i < 100; ++i) {
      vehicle.step(20 * kMs);
      if (film) film->take(vehicle);
    }
    const auto pose = vehicle.pose();
    return std::vector<double>{pose.x_m, pose.y_m, pose.theta_rad};
  };
  EXPECT_EQ(course(true, "frames"), course(false, ""));
}

template <typename Kind>
std::string refusal(const vehicle::Vehicle& vehicle, const FilmOptions& options) {
  try {
    Film film(vehicle, options);
    film.take(vehicle);
    film.finish(vehicle);
  } catch (const Kind& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("another kind of error: ") + error.what();
  }
  return "no error";
}

TEST_F(FilmTest, WhatCannotBeWrittenIsRefused) {
  const vehicle::Vehicle vehicle = world_.vehicle();
  EXPECT_EQ(refusal<ConfigurationError>(vehicle, {.path = "film.avy"}),
            "cannot write 'film.avy': no film has the ending '.avy'; write .mp4, .webm, .mkv or "
            ".gif, .png for a picture of the end, or a directory's name for single pictures");
  std::filesystem::create_directories(path("old"));
  directory_.write("old/frame_000007.png", "");
  EXPECT_EQ(refusal<FileError>(vehicle, {.path = path("old")}),
            "cannot write pictures into '" + path("old") +
                "': it has 'frame_000007.png' already; remove them, or write another directory");
  EXPECT_THAT(refusal<FileError>(vehicle, {.path = "/proc/frames"}),
              Fault("cannot make directory '/proc/frames': ... [SL0109]"));
  EXPECT_THAT(refusal<FileError>(vehicle, {.path = "/nowhere/end.png"}),
              Fault("cannot write '/nowhere/end.png': ... [SL0109]"));
  EXPECT_THAT(refusal<FileError>(vehicle, {.path = "/nowhere/film.mp4"}),
              Fault("cannot create '/nowhere/film.mp4': ... [SL0109]"));
}

TEST_F(FilmTest, APictureThatCannotBeWrittenIsRefusedBeforeTheDrive) {
  const vehicle::Vehicle vehicle = world_.vehicle();
  EXPECT_THROW(Film(vehicle, {.path = "/nowhere/end.png"}), FileError);
  std::filesystem::create_directories(path("folder.png"));
  EXPECT_THROW(Film(vehicle, {.path = path("folder.png")}), FileError);
  directory_.write("old.png", "an old picture");
  { const Film film(vehicle, {.path = path("old.png")}); }
  EXPECT_EQ(directory_.read("old.png"), "an old picture") << "until there is another one";
  { const Film film(vehicle, {.path = path("new.png")}); }
  EXPECT_FALSE(std::filesystem::exists(path("new.png")));
}

TEST_F(FilmTest, WithoutFfmpegItSaysSo) {
  const std::string old = ::getenv("PATH");
  ::setenv("PATH", directory_.path().c_str(), 1);
  const std::string text = refusal<ConfigurationError>(world_.vehicle(), {.path = path("a.mp4")});
  ::setenv("PATH", old.c_str(), 1);
  EXPECT_EQ(text,
            "cannot write '" + path("a.mp4") +
                "': ffmpeg, which makes films, is not installed; write a directory for single "
                "pictures, or install it:  apt-get install ffmpeg");
}

TEST(FilmWords, ViewsAndSizes) {
  using testing::ElementsAre;
  EXPECT_THAT(views_named("chase"), ElementsAre(View::chase));
  EXPECT_THAT(views_named("camera+above"), ElementsAre(View::camera, View::above));
  for (const char* wrong : {"", "above+", "front"}) {
    try {
      views_named(wrong);
      FAIL() << wrong;
    } catch (const ConfigurationError& error) {
      EXPECT_THAT(error.what(),
                  testing::EndsWith("write above, chase, camera, or several of them as "
                                    "above+chase"));
    }
  }
  EXPECT_EQ(size_named("640x480"), (Size{640, 480}));
  for (const char* wrong : {"", "640", "640x", "x480", "640x480x2", "0x480", "640x5000", "-1x2"}) {
    try {
      size_named(wrong);
      FAIL() << wrong;
    } catch (const ConfigurationError& error) {
      EXPECT_EQ(
          std::string(error.what()),
          "'" + std::string(wrong) +
              "' is not a size of a picture; write WIDTHxHEIGHT in pixels, at most 4096 each, as "
              "960x720");
    }
  }
}

}  // namespace
}  // namespace spikeloop::pictures
