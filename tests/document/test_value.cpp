#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/document/value.h"

namespace normalshop {
namespace {

std::string value_message(std::string_view json) {
  try {
    parse_json(json, "a.json");
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "accepted";
}

TEST(ParseJson, KeepsTheOrderOfFieldsAndEveryKindOfValue) {
  const Value v =
      parse_json(R"({"z": [1, -2.5e3], "a": {"b": true}, "m": null, "k": "\u00e4"})", "");
  ASSERT_NE(v.object(), nullptr);
  ASSERT_EQ(v.object()->size(), 4U);
  EXPECT_EQ(v.object()->at(0).first, "z");
  EXPECT_EQ(v.object()->at(1).first, "a");
  EXPECT_EQ(*v.find("z")->array()->at(1).number(), -2500.0);
  EXPECT_TRUE(*v.find("a")->find("b")->boolean());
  EXPECT_TRUE(v.find("m")->is_null());
  EXPECT_EQ(*v.find("k")->text(), "\xc3\xa4");
  EXPECT_EQ(v.find("missing"), nullptr);
}

TEST(ParseJson, RepeatedNamesAreNamedWithTheirLine) {
  EXPECT_EQ(value_message("{\n\"a\": 1,\n\"a\": 2}"),
            "a.json: line 3: the field \"a\" appears twice in one object");
  EXPECT_EQ(value_message(R"([{"a": 1}, {"a": 2}])"), "accepted");
}

TEST(ParseJson, NestsAHundredLevelsAndNoDeeper) {
  EXPECT_EQ(value_message(std::string(100, '[') + std::string(100, ']')), "accepted");
  EXPECT_EQ(value_message("\n" + std::string(101, '[') + std::string(101, ']')),
            "a.json: line 2: nested more than 100 levels deep");
  EXPECT_EQ(value_message(std::string(1000000, '[')),
            "a.json: line 1: nested more than 100 levels deep");
}

TEST(ParseJson, TokensThatAreNoJsonAreNamedWithTheirLine) {
  EXPECT_EQ(value_message("[\nNaN]"),
            "a.json: line 2: not valid JSON: invalid literal; last read: '[<U+000A>N'");
  EXPECT_EQ(value_message("[Infinity]"),
            "a.json: line 1: not valid JSON: invalid literal; last read: '[I'");
  EXPECT_EQ(value_message("[1e999]"),
            "a.json: line 1: not valid JSON: number overflow parsing '1e999'");
  for (const std::string_view bad : {"", "{", "[1,]", "{} {}", "// x\n1", "{'a': 1}", "[+1]",
                                     "[.5]", "\"\xff\"", "\"\xc3(\"", "{\"a\": 1,}", "tru"}) {
    const std::string text = value_message(bad);
    EXPECT_TRUE(text.starts_with("a.json: line ")) << bad << " -> " << text;
    EXPECT_NE(text.find("not valid JSON: "), std::string::npos) << text;
    for (const char c : text) EXPECT_TRUE(c >= ' ' && c <= '~') << text;
  }
}

TEST(ParseJson, AVeryLongFaultMakesAShortMessage) {
  EXPECT_LT(value_message("[\"" + std::string(1000000, 'x')).size(), 300U);
}

TEST(ParseJson, AnObjectOfManyFieldsTakesNoSquareOfThem) {
  std::string json = "{";
  for (int i = 0; i < 200000; ++i) json += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":0";
  EXPECT_EQ(parse_json(json + "}", "").object()->size(), 200000U);
}

TEST(ToJson, NumbersReadBackAsTheSameNumber) {
  for (const double number : {0.0, 1.0, -1.0, 0.1, 1.0 / 3.0, 1e-300, 1.7e308, 1e15, 123456789012.5,
                              9007199254740993.0, 5e-324}) {
    const std::string text = to_json(Value(number));
    const Value back = parse_json(text, "");
    const bool single = static_cast<double>(static_cast<float>(std::min(number, 1e38))) == number;
    if (single) {
      EXPECT_EQ(static_cast<float>(*back.number()), static_cast<float>(number)) << text;
    } else {
      EXPECT_EQ(*back.number(), number) << text;
    }
  }
}

TEST(ToJson, FloatsPrintShortAndReadBackAsTheSameFloat) {
  EXPECT_EQ(to_json(Value(0.1F)), "0.1\n");
  EXPECT_EQ(to_json(Value(1000000)), "1000000\n");
  for (const float number : {0.1F, 1.0F / 3.0F, 16777217.0F, 1e-38F, 3.4e38F, 1e-45F, 7.3e-5F}) {
    const Value back = parse_json(to_json(Value(number)), "");
    EXPECT_EQ(static_cast<float>(*back.number()), number);
  }
  EXPECT_EQ(to_json(Value(std::numeric_limits<float>::infinity())), "null\n");
  EXPECT_EQ(to_json(Value(std::nan(""))), "null\n");
}

TEST(ToJson, TextsReadBackWhateverTheyHold) {
  const std::string text =
      "quote \" slash \\ line \n tab \t nul " + std::string(1, '\0') + " \xc3\xa4";
  EXPECT_EQ(*parse_json(to_json(Value(text)), "").text(), text);
  EXPECT_EQ(*parse_json(to_json(Value("\xff")), "").text(), "\xef\xbf\xbd");
}

TEST(Value, DescribesItselfInFewWords) {
  EXPECT_EQ(Value("wide").describe(), "the text \"wide\"");
  EXPECT_EQ(Value(7).describe(), "the number 7");
  EXPECT_EQ(Value(Value::Array{1, 2}).describe(), "a list of 2");
  EXPECT_EQ(Value(Value::Object{}).describe(), "an object");
  EXPECT_EQ(Value().describe(), "null");
  // 59 letters and two-byte characters: cut before the one that does not fit.
  EXPECT_EQ(Value(std::string(59, 'x') + "\xc3\xa4\xc3\xa4").describe(),
            "the text \"" + std::string(59, 'x') + "...\"");
}

}  // namespace
}  // namespace normalshop
