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
  const Hashes mesh{0x972902ac95280dc3, 0x80fd04081f9012ec, 0xec3c1fb5ed0aba1a, 0x80c7c780061ad746,
                    0x419f6b6fd4aea665, 0x5ad99de13412b04a, 0x3c40019d526c6811, 0x857d535952995bfd,
                    0xedb6e63f495e516b, 0x7469e978e0491576, 0x9016d7f786b6b8b,  0x7e2ac571d2eb456d,
                    0x1ea31c37bbedcba6, 0x958800a0793c7b9d, 0xe81661097ba7faa4, 0x1e0b3f070531fa75,
                    0xcef9ebc767bdca24, 0x4da865f0033867be};
  const Hashes picture{0x3b23505710a9c534, 0xff7282e11bacb3ee, 0xb58da5fc8b930ded,
                       0xb2929e9ad8877b3c, 0x613ff1e3f6d4253f, 0x2753c4ad89b427c5,
                       0x4e83676727da885c, 0x463fffba58885836, 0x5184f3856751cf38,
                       0x39ad45ddc9915a1b, 0xd882a9cb44bc51ba, 0xbd152b36a0433c56,
                       0x2773af151df5de50, 0x48dcf00b31755757, 0x755bc773a732049a,
                       0x44c2e65d059e035e, 0x9cd4566f24e8c4a4, 0x93aba8e1587b1f75};
  Hashes found = edit_picture(Border::Wrap);
  found.pop_back();  // the colours, in single precision, which no file holds
  expect_same(edit_mesh(), mesh, "mesh");
  expect_same(found, picture, "picture");
  expect_same(edit_directions(),
              {0xc7ca3b1d8025ed23, 0xbec512eaf9ede4e5, 0x812bae2cc6e65d16, 0x91e8e33dd30bdf9,
               0x2c2f4501ed8ad15a, 0xb20d20e8024fd167},
              "directions");
}

}  // namespace
}  // namespace normalshop::test
