#include <cstdint>
#include <sstream>

#include "document/operator_cases.h"
#include <hwy/targets.h>

#include "normalshop/core/parallel.h"
#include "normalshop/document/image_document.h"

/// The same recipe gives the same codes: on any number of threads, and on any machine.
namespace normalshop::test {
namespace {

constexpr int side = 128;

/// FNV-1a.
class Hash {
 public:
  void add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3U;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

std::uint64_t hash_of(const NormalMap& map) {
  const RawImage codes = map.encode();
  Hash hash;
  hash.add(codes.data(), codes.size_bytes());
  return hash.value();
}

/// After every edit of a recipe with all operators.
using Hashes = std::vector<std::uint64_t>;

Hashes edit_mesh() {
  Document plane = document(plane_grid(2), noise_map(side, CodeType::U16));
  Hashes hashes;
  for (const OperatorCase& one : operator_cases(1.0)) {
    plane.apply(edit_of(one));
    hashes.push_back(hash_of(map_of(plane)));
  }
  return hashes;
}

/// After edits that displace along other directions than the viewer's, seen aslant.
Hashes edit_directions() {
  Document plane = document(plane_grid(2), noise_map(side, CodeType::U16));
  Hashes hashes;
  for (const char* mode : {R"("base")", R"({"along": [0.5, -0.3, 0.8]})"}) {
    for (const OperatorCase& one : operator_cases(1.0)) {
      if (one.name != "pen" && one.name != "smooth" && one.name != "flatten") continue;
      plane.apply(edit("\"operator\": \"" + one.name + R"(", "options": {)" + one.options +
                       R"(}, "strokes": )" + one.strokes + R"(, "mode": )" + mode +
                       R"(, "view": {"direction": [0.3, 0.2, 1]})"));
      hashes.push_back(hash_of(map_of(plane)));
    }
  }
  return hashes;
}

Hashes edit_picture(Border border) {
  ImageDocument::Images images;
  images.normals = noise_map(side, CodeType::U16);
  images.colors = ColorImage(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) images.colors(x, y) = images.normals.normal(x, y).cwiseAbs();
  }
  images.border = border;
  ImageDocument picture(std::move(images));
  Hashes hashes;
  for (const OperatorCase& one : operator_cases(side)) {
    picture.apply(edit_of(one));
    hashes.push_back(hash_of(picture.normals()));
  }
  Hash colors;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) colors.add(picture.colors()(x, y).data(), 3 * sizeof(float));
  }
  hashes.push_back(colors.value());
  return hashes;
}

std::string name_of_edit(std::size_t i) {
  const std::vector<OperatorCase> cases = operator_cases(1.0);
  return i < cases.size() ? cases[i].name : "the colours";
}

/// To be written into the test where an operator changes on purpose.
std::string listed(const Hashes& hashes) {
  std::ostringstream text;
  for (const std::uint64_t hash : hashes) text << "0x" << std::hex << hash << ", ";
  return text.str();
}

void expect_same(const Hashes& found, const Hashes& expected, const std::string& where) {
  ASSERT_EQ(found.size(), expected.size()) << where << "; all: " << listed(found);
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i], expected[i])
        << where << ", after " << name_of_edit(i) << "; all: " << listed(found);
  }
}

TEST(Determinism, TriesEveryOperator) { EXPECT_EQ(names_of_cases(), names_of_registry()); }

TEST(Determinism, EveryEditChangesSomething) {
  const Hashes mesh = edit_mesh();
  const Hashes picture = edit_picture(Border::Wrap);
  for (std::size_t i = 1; i < operator_cases(1.0).size(); ++i) {
    EXPECT_NE(mesh[i], mesh[i - 1]) << name_of_edit(i);
    EXPECT_NE(picture[i], picture[i - 1]) << name_of_edit(i);
  }
}

TEST(Determinism, ThreadsDoNotMatter) {
  const auto on_one_thread = [](const auto& run) {
    const ThreadLimit one(1);
    return run();
  };
  expect_same(edit_mesh(), on_one_thread(edit_mesh), "mesh");
  expect_same(edit_directions(), on_one_thread(edit_directions), "directions");
  for (const Border border : {Border::Clamp, Border::Mirror, Border::Wrap}) {
    const auto run = [&] { return edit_picture(border); };
    expect_same(run(), on_one_thread(run), "picture, " + std::string(name_of(border)));
  }
}

/// Kernels compiled for one of the processor's instruction sets alone.
class InstructionSet {
 public:
  explicit InstructionSet(std::int64_t target) { choose(target); }
  ~InstructionSet() { choose(0); }  // the best of all
  InstructionSet(const InstructionSet&) = delete;
  InstructionSet& operator=(const InstructionSet&) = delete;

 private:
  static void choose(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST(Determinism, InstructionSetsDoNotMatter) {
  const Hashes mesh = edit_mesh();
  const Hashes directions = edit_directions();
  const Hashes picture = edit_picture(Border::Wrap);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const InstructionSet only(target);
    ASSERT_EQ(hwy::SupportedTargets(), target);
    expect_same(edit_mesh(), mesh, "mesh, " + std::string(hwy::TargetName(target)));
    expect_same(edit_directions(), directions,
                "directions, " + std::string(hwy::TargetName(target)));
    expect_same(edit_picture(Border::Wrap), picture,
                "picture, " + std::string(hwy::TargetName(target)));
  }
}

/// What this machine finds is what g++ at -O3 and clang at -O1 with sanitizers found, and the C
/// library with and without its fused multiply-add. Codes of 16 bits would show a difference of
/// 3e-5; there is none, since nothing is contracted and no sum depends on the width of vectors. An
/// operator that changes what it does on purpose changes its hash and those that follow.
TEST(Determinism, CodesAreThoseOfOtherMachines) {
  const Hashes mesh{0x6b72a23404c82c92, 0xdc59ff932aab6e1b, 0x39f421a45739c34f, 0xa3fe880678651666,
                    0x23f0e2118b4cad2e, 0x73ce555cd109a7bb, 0xa23e224f80b23ffe, 0x8bcb4ac7b7878d53,
                    0xca1a9723db736b75, 0xf8828a0e4cbcb6b2, 0x7a48fa3bb9daef23, 0xd4cc386e137221bf,
                    0x1aa761725a862794, 0x9c7285176bfa44f9, 0x484ad8d32fff8f8a, 0xcf777b86a52f9758,
                    0x31c340fb0aae402,  0xfe2c013a21ade5e0};
  const Hashes picture{0x1dc6daa8608246c6, 0x1e02136c647741b,  0x93384ef6bbdb3f3a,
                       0xfe2f4b94d3128e6a, 0x924d9c9134e34f92, 0x68bdd4b0340ee048,
                       0x9c833f8a5ad7c759, 0xfa3b6f74427be1ba, 0xd1c98e512cd77db,
                       0xd70db48c9316c07,  0x102035e407aeb29d, 0x54830301e924b00f,
                       0x690b85168f0f2f84, 0x2b2078a1370cb633, 0xf1a1ea0925b46c9c,
                       0x4f72d16eeda30d2b, 0xfe87c300813213fd, 0x2e52213e492bf65e};
  Hashes found = edit_picture(Border::Wrap);
  found.pop_back();  // the colours, in single precision, which no file holds
  expect_same(edit_mesh(), mesh, "mesh");
  expect_same(found, picture, "picture");
  expect_same(edit_directions(),
              {0x6e4d298b747f25c7, 0x5a8189d1ae1489b4, 0xc2c6184aee379c52, 0x8b6c86fb66753fd2,
               0xf38efe1946196b91, 0xbe045bbdd022cd2c},
              "directions");
}

}  // namespace
}  // namespace normalshop::test
