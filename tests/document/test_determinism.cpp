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
  const Hashes mesh{0x394ae9553318351a, 0xd656fd7351f240e2, 0x1ad83d9c50a085e0, 0x8768d4e56297cc34,
                    0x1de59cd66a9e98e,  0x7f87dee553e9871d, 0x3c18a6527e482fc1, 0x1e289ee3d67b2671,
                    0x8c29d1f66a24afcc, 0x564adebd5bbfd78e, 0x9016d7f786b6b8b,  0x7e2ac571d2eb456d,
                    0x1ea31c37bbedcba6, 0x7311c3e52181f403, 0x3b6de694d77ff84f, 0xeb7cc090c3b83ad0,
                    0xa8d091d5d26d0159, 0x4bee6a26aa9dce6f};
  const Hashes picture{0x5e214a957a4cdca7, 0x390df36fa74eaf08, 0xe9eb466298078703,
                       0x7cd939770ce3e6c2, 0xf669536d14a7ba31, 0x361e0f6ce33244d7,
                       0x4e83676727da885c, 0xaaecf05083b6ea41, 0x23b92c67ca9c0993,
                       0xbd543848a0b1a3bc, 0xca88586b208014b3, 0x864122b7533b1c27,
                       0x3aa29f8704db26f5, 0xc4538d07c1950e6a, 0x755bc773a732049a,
                       0x94f8dc3ba277945b, 0x95c842456e489a6f, 0x4977181db777b86};
  Hashes found = edit_picture(Border::Wrap);
  found.pop_back();  // the colours, in single precision, which no file holds
  expect_same(edit_mesh(), mesh, "mesh");
  expect_same(found, picture, "picture");
  expect_same(edit_directions(),
              {0xc295a7f0ea54011f, 0xff114145a73c0f55, 0x979b9ef930b5f82, 0x76a9c169ca4f3655,
               0xe388fb625fe2ef9a, 0x6b1959da2cb21152},
              "directions");
}

}  // namespace
}  // namespace normalshop::test
