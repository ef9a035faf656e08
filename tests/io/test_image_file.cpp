#include <cstring>
#include <fstream>
#include <functional>
#include <limits>

#include "io/temp_folder.h"
#include "support/data.h"
#include "support/same_codes.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/core/random.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"

namespace normalshop {
namespace {

using test::files_in;
using test::TempFolder;

/// Every code differs from its neighbours; alpha is low, so that any multiplication by it shows.
RawImage noise(int width, int height, int channels, CodeType type) {
  RawImage image(width, height, channels, type);
  Random random(7);
  for (int y = 0; y < height; ++y) {
    for (int i = 0; i < width * channels; ++i) {
      const bool alpha = channels == 4 && i % 4 == 3;
      if (type == CodeType::U8) {
        image.row<std::uint8_t>(y)[i] =
            static_cast<std::uint8_t>(random.next() % (alpha ? 9 : 256));
      } else if (type == CodeType::U16) {
        image.row<std::uint16_t>(y)[i] =
            static_cast<std::uint16_t>(random.next() % (alpha ? 99 : 65536));
      } else {
        image.row<float>(y)[i] = random.uniform(-2.0F, alpha ? -1.0F : 3.0F);
      }
    }
  }
  return image;
}

void expect_equal(const RawImage& a, const RawImage& b) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  ASSERT_EQ(a.channels(), b.channels());
  ASSERT_EQ(a.type(), b.type());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0);
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "(nothing was thrown)";
}

struct Case {
  const char* extension;
  CodeType type;
  int channels;
};

class RoundTrip : public ::testing::TestWithParam<Case> {};

TEST_P(RoundTrip, KeepsEveryCode) {
  const TempFolder folder;
  const auto [extension, type, channels] = GetParam();
  for (const auto& [width, height] : {std::pair{37, 21}, {1, 1}, {1, 300}}) {
    const RawImage image = noise(width, height, channels, type);
    const auto path = folder / (std::string("map") + extension);
    write_image(path, image);
    expect_equal(read_image(path), image);
  }
  EXPECT_EQ(files_in(folder.path()), 1U);
}

std::vector<Case> exact_cases() {
  std::vector<Case> cases;
  for (int channels = 1; channels <= 4; ++channels) {
    for (const char* extension : {".png", ".tif", ".TIFF"}) {
      cases.push_back({extension, CodeType::U8, channels});
      cases.push_back({extension, CodeType::U16, channels});
    }
    cases.push_back({".tiff", CodeType::F32, channels});
    cases.push_back({".exr", CodeType::F32, channels});
    if (channels != 2) cases.push_back({".tga", CodeType::U8, channels});
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip, ::testing::ValuesIn(exact_cases()),
                         [](const auto& test) {
                           const Case& c = test.param;
                           return std::string(c.extension + 1) + "_" +
                                  std::to_string(8 * RawImage::code_size(c.type)) + "_" +
                                  std::to_string(c.channels);
                         });

TEST(ImageFile, RowsOneAfterTheOtherMakeTheSameImage) {
  const test::TempFolder folder;
  for (const char* name : {"rows.png", "rows.tif", "rows.exr", "rows.tga"}) {
    const bool floats = std::string_view(name).ends_with("exr");
    const NormalMap map = flat_normal_map(7, 300, floats ? CodeType::F32 : CodeType::U8);
    RawImage codes = map.encode();
    for (int y = 0; y < 300; ++y) codes.row_data(y)[y % 21] = static_cast<std::uint8_t>(y / 4);
    const NormalMap uneven(codes, map.convention());
    write_image(folder / name, 300, [&](int y, int count) {
      return uneven.encode_rows(y, count, codes.type(), map.convention());
    });
    EXPECT_TRUE(test::same_codes(read_image(folder / name), codes)) << name;
  }
}

TEST(ImageFile, HalfFloatsKeepElevenBits) {
  const TempFolder folder;
  const RawImage image = noise(33, 17, 3, CodeType::F32);
  write_image(folder / "half.exr", image, {.half_float = true});
  const RawImage back = read_image(folder / "half.exr");
  ASSERT_EQ(back.type(), CodeType::F32);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const float expected = image.code(x, y, c);
        EXPECT_NEAR(back.code(x, y, c), expected, std::abs(expected) / 2048.0F + 1e-7F);
      }
    }
  }
}

TEST(ImageFile, JpegStaysClose) {
  const TempFolder folder;
  RawImage image(64, 64, 3, CodeType::U8);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) {
        image.row<std::uint8_t>(y)[3 * x + c] =
            static_cast<std::uint8_t>(64 + 2 * (c == 0 ? x : y));
      }
    }
  }
  write_image(folder / "map.jpg", image);
  const RawImage back = read_image(folder / "map.jpg");
  ASSERT_EQ(back.channels(), 3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(back.code(x, y, c), image.code(x, y, c), 3.0F);
    }
  }
}

TEST(ImageFile, RefusesWhatAFormatCannotHold) {
  const TempFolder folder;
  const RawImage floats = noise(4, 4, 3, CodeType::F32);
  EXPECT_THROW(write_image(folder / "a.png", floats), InvalidInput);
  EXPECT_THROW(write_image(folder / "a.exr", noise(4, 4, 3, CodeType::U8)), InvalidInput);
  EXPECT_THROW(write_image(folder / "a.jpg", noise(4, 4, 4, CodeType::U8)), InvalidInput);
  EXPECT_THROW(write_image(folder / "a.tga", noise(4, 4, 3, CodeType::U16)), InvalidInput);
  EXPECT_THROW(write_image(folder / "a.webp", noise(4, 4, 3, CodeType::U8)), InvalidInput);
  EXPECT_THROW(write_image(folder / "a.png", RawImage()), InvalidInput);
  EXPECT_EQ(files_in(folder.path()), 0U);
}

TEST(ImageFile, TruncatedFilesAreErrors) {
  const TempFolder folder;
  for (const Case& c : {Case{".png", CodeType::U8, 3},
                        {".png", CodeType::U16, 4},
                        {".tif", CodeType::U16, 3},
                        {".exr", CodeType::F32, 3},
                        {".jpg", CodeType::U8, 3},
                        {".tga", CodeType::U8, 4}}) {
    const auto path = folder / (std::string("map") + c.extension);
    write_image(path, noise(64, 64, c.channels, c.type));
    const std::string whole = read_file(path);
    for (const double part : {0.0, 0.001, 0.1, 0.5, 0.9}) {
      const auto size = static_cast<std::size_t>(part * static_cast<double>(whole.size()));
      write_file(path, std::string_view(whole).substr(0, size));
      const std::string message = message_of([&] { read_image(path); });
      EXPECT_NE(message.find(path.string()), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
}

TEST(ImageFile, RandomBytesAreErrorsOrImages) {
  const TempFolder folder;
  Random random(3);
  for (const char* extension : {".png", ".tif", ".exr", ".jpg", ".tga"}) {
    const auto path = folder / (std::string("map") + extension);
    write_image(path,
                noise(32, 32, 3, std::strcmp(extension, ".exr") ? CodeType::U8 : CodeType::F32));
    const std::string whole = read_file(path);
    for (int attempt = 0; attempt < (test::sanitized ? 8 : 40);
         ++attempt) {  // a fuzzer does it, too
      std::string bytes = whole;
      const std::size_t keep = attempt % 2 == 0 ? 0 : 20;
      for (std::size_t i = keep; i < bytes.size(); ++i) {
        if (attempt % 4 < 2 || random.next() % 50 == 0) bytes[i] = static_cast<char>(random.next());
      }
      // Some damage cannot be seen.
      try {
        const RawImage image = read_image(std::as_bytes(std::span(bytes)), "noise");
        EXPECT_TRUE(image.channels() >= 1 && image.channels() <= 4);
        EXPECT_EQ(image.size_bytes(), image.row_bytes() * static_cast<std::size_t>(image.height()));
        EXPECT_FALSE(image.empty());
      } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("'noise'"), std::string::npos) << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
}

/// A PNG whose header states a size that its data does not have.
std::string png_header(std::uint32_t width, std::uint32_t height) {
  const auto big_endian = [](std::uint32_t v) {
    return std::string{static_cast<char>(v >> 24), static_cast<char>(v >> 16),
                       static_cast<char>(v >> 8), static_cast<char>(v)};
  };
  using namespace std::string_literals;
  return "\x89PNG\r\n\x1a\n"s + big_endian(13) + "IHDR" + big_endian(width) + big_endian(height) +
         "\x08\x02\0\0\0"s + big_endian(0);
}

TEST(ImageFile, ImpossibleSizesAreRefusedBeforeMemoryIsTaken) {
  for (const auto& [width, height] :
       {std::pair{0U, 0U}, {0U, 5U}, {100000U, 100000U}, {65537U, 1U}, {65536U, 65536U}}) {
    const std::string bytes = png_header(width, height);
    const std::string message =
        message_of([&] { read_image(std::as_bytes(std::span(bytes)), "big.png"); });
    EXPECT_NE(message.find("accepted are 1 to 65536 a side"), std::string::npos) << message;
    EXPECT_NE(message.find(std::to_string(width)), std::string::npos) << message;
  }
  const std::string short_file = png_header(60000, 10000);
  EXPECT_THROW(read_image(std::as_bytes(std::span(short_file)), "short.png"), IoError);
  using namespace std::string_literals;
  const std::string with_end = short_file + "\0\0\0\0IDAT\0\0\0\0\0\0\0\0IEND\0\0\0\0"s;
  EXPECT_THROW(read_image(std::as_bytes(std::span(with_end)), "short.png"), IoError);
}

TEST(ImageFile, MissingFilesFoldersAndUnwritablePlacesAreNamed) {
  const TempFolder folder;
  const RawImage image = noise(4, 4, 3, CodeType::U8);
  EXPECT_THROW(read_image(folder / "missing.png"), IoError);
  EXPECT_THROW(read_image(folder.path()), IoError);
  EXPECT_THROW(read_image("/dev/zero"), IoError);
  EXPECT_THROW(write_image(folder / "none/a.png", image), IoError);
  EXPECT_THROW(write_image("/proc/a.png", image), IoError);
  std::filesystem::create_directory(folder / "a.png");
  EXPECT_THROW(write_image(folder / "a.png", image), IoError);
  write_file(folder / "text.png", std::string_view("hello"));
  const std::string message = message_of([&] { read_image(folder / "text.png"); });
  EXPECT_NE(message.find("accepted are PNG"), std::string::npos) << message;
  EXPECT_EQ(files_in(folder.path()), 2U);
}

TEST(ImageFile, AFailedWriteLeavesTheOldFileAndNoTrace) {
  const TempFolder folder;
  write_file(folder / "a.txt", std::string_view("old"));
  {
    PendingFile pending(folder / "a.txt");
    std::ofstream(pending.path()) << "half";
    EXPECT_EQ(files_in(folder.path()), 2U);
  }
  EXPECT_EQ(files_in(folder.path()), 1U);
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
}

TEST(ImageFile, TheNameDoesNotMatterOnlyTheBytes) {
  const TempFolder folder;
  const RawImage image = noise(5, 5, 3, CodeType::U16);
  write_image(folder / "a.png", image);
  std::filesystem::rename(folder / "a.png", folder / "a.jpg");
  expect_equal(read_image(folder / "a.jpg"), image);
}

TEST(ColorFile, EverySrgbCodeComesBack) {
  const TempFolder folder;
  RawImage codes(256, 1, 3, CodeType::U8);
  for (int i = 0; i < 768; ++i) codes.data()[i] = static_cast<std::uint8_t>(i / 3);
  write_image(folder / "in.png", codes);
  const ColorImage color = color_from_codes(read_image(folder / "in.png"));
  EXPECT_NEAR(color(128, 0).x(), 0.2158605, 1e-6);
  EXPECT_EQ(color(0, 0).x(), 0.0F);
  EXPECT_EQ(color(255, 0).x(), 1.0F);
  write_png_srgb(folder / "out.png", color);
  expect_equal(read_image(folder / "out.png"), codes);
}

TEST(ColorFile, ClampsAndIgnoresWhatIsNoColour) {
  const TempFolder folder;
  ColorImage color(2, 1);
  color(0, 0) = Vec3f(-1.0F, 7.0F, std::nanf(""));
  color(1, 0) = Vec3f(std::numeric_limits<float>::infinity(), 0.0F, 1.0F);
  write_png_srgb(folder / "out.png", color);
  const RawImage back = read_image(folder / "out.png");
  EXPECT_EQ(back.code(0, 0, 0), 0.0F);
  EXPECT_EQ(back.code(0, 0, 1), 255.0F);
  EXPECT_EQ(back.code(0, 0, 2), 0.0F);
  EXPECT_EQ(back.code(1, 0, 0), 255.0F);
}

TEST(ColorFile, GrayIsRepeated) {
  RawImage gray(1, 1, 2, CodeType::U16);
  gray.row<std::uint16_t>(0)[0] = 65535;
  gray.row<std::uint16_t>(0)[1] = 0;
  EXPECT_EQ(color_from_codes(gray)(0, 0), Vec3f(1.0F, 1.0F, 1.0F));
}

TEST(ImageFile, RealMapsHaveTheirKnownSizes) {
  const auto rosewood = test::data_file("mat_rosewood_veneer/rosewood_veneer1_nor_gl_1k.png");
  const auto face = test::data_file("lee_perry_smith/Infinite-Level_02_Tangent_SmoothUV.jpg");
  if (!rosewood || !face) GTEST_SKIP() << "the real data is not on this machine";
  const RawImage wood = read_image(*rosewood);
  EXPECT_EQ(wood.type(), CodeType::U16);
  EXPECT_EQ(wood.width(), 1024);
  const RawImage map = read_image(*face);
  EXPECT_EQ(map.type(), CodeType::U8);
  EXPECT_EQ(map.channels(), 3);
  EXPECT_EQ(map.height(), 1024);
}

}  // namespace
}  // namespace normalshop
