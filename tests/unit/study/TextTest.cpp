// SPDX-License-Identifier: GPL-3.0-or-later
// Character sets: the worked examples of PS3.5 annexes H to K, byte by byte, and what may go wrong.
#include "Text.h"

#include <gtest/gtest.h>

namespace vernier {
namespace {
using namespace std::string_literals;
using Charset = std::vector<std::string>;

void expectText(std::string bytes, const Charset& charset, const std::string& utf8, bool name = true) {
  const DecodedText t = decodeText(bytes, charset, name);
  EXPECT_EQ(t.utf8, utf8);
  EXPECT_FALSE(t.damaged);
}

TEST(Text, SingleByteSets) {
  expectText("Buc^J\xe9r\xf4me", {"ISO_IR 100"}, "Buc^Jérôme");
  expectText(
      "\xc4neas^R\xfc"
      "diger",
      {"ISO_IR 100"}, "Äneas^Rüdiger");
  expectText(
      "W\xb3"
      "adys\xb3"
      "aw",
      {"ISO_IR 101"}, "Władysław");
  expectText(
      "\xbb\xee\xda"
      "ce\xdc\xd1yp\xd3",
      {"ISO_IR 144"}, "Люкceмбypг");
  expectText("\xc4\xe9\xef\xed\xf5\xf3\xe9\xef\xf2", {"ISO_IR 126"}, "Διονυσιος");
  expectText("\xe2\xc8\xc7\xe6\xea^\xe4\xe6\xd2\xc7\xd1", {"ISO_IR 127"}, "قباني^لنزار");
  expectText("\xf9\xf8\xe5\xef^\xe3\xe1\xe5\xf8\xe4", {"ISO_IR 138"}, "שרון^דבורה");
}

TEST(Text, JapaneseWithEscapes) {
  // PS3.5 H.3.1
  expectText("Yamada^Tarou=\x1b$B;3ED\x1b(B^\x1b$BB@O:\x1b(B=\x1b$B$d$^$@\x1b(B^\x1b$B$?$m$&\x1b(B",
             {"", "ISO 2022 IR 87"}, "Yamada^Tarou=山田^太郎=やまだ^たろう");
  // PS3.5 H.3.2
  expectText(
      "\xd4\xcf\xc0\xde^\xc0\xdb\xb3=\x1b$B;3ED\x1b(J^\x1b$BB@O:\x1b(J=\x1b$B$d$^$@\x1b(J^\x1b$B$?$m$&\x1b(J",
      {"ISO 2022 IR 13", "ISO 2022 IR 87"}, "ﾔﾏﾀﾞ^ﾀﾛｳ=山田^太郎=やまだ^たろう");
}

TEST(Text, KoreanWithEscapes) {
  // PS3.5 I.2
  expectText("Hong^Gildong=\x1b$)C\xfb\xf3^\x1b$)C\xd1\xce\xd4\xd7=\x1b$)C\xc8\xab^\x1b$)C\xb1\xe6\xb5\xbf",
             {"", "ISO 2022 IR 149"}, "Hong^Gildong=洪^吉洞=홍^길동");
}

TEST(Text, Utf8AndChinese) {
  // PS3.5 J.1 and J.3
  expectText("Wang^XiaoDong=\xe7\x8e\x8b^\xe5\xb0\x8f\xe6\x9d\xb1=", {"ISO_IR 192"}, "Wang^XiaoDong=王^小東");
  expectText("Wang^XiaoDong=\xcd\xf5^\xd0\xa1\xb6\xab=", {"GB18030"}, "Wang^XiaoDong=王^小东");
  // PS3.5 K.2
  expectText("Zhang^XiaoDong=\x1b$)A\xd5\xc5^\x1b$)A\xd0\xa1\xb6\xab=", {"", "ISO 2022 IR 58"},
             "Zhang^XiaoDong=张^小东");
}

TEST(Text, DelimitersBringBackTheFirstSet) {
  // After "^" and "=" the katakana of G1 are gone until a new escape: what has no set is damaged, not
  // guessed.
  const DecodedText t = decodeText("\x1b$)C\xc8\xab^\xb1\xe6", {"", "ISO 2022 IR 149"}, true);
  EXPECT_TRUE(t.damaged);
  EXPECT_EQ(t.utf8.substr(0, 4), "홍^");
  // In other text "^" and "=" are plain characters.
  EXPECT_FALSE(decodeText("\x1b$)C\xc8\xab^\xb1\xe6", {"", "ISO 2022 IR 149"}, false).damaged);
}

TEST(Text, BackslashInsideATwoByteCharacterDoesNotSplit) {
  // JIS X 0208 has characters whose second byte is 0x5C: 0x3D5C is a kanji.
  const DecodedText t = decodeText("\x1b$B=\\\x1b(B", {"", "ISO 2022 IR 87"}, false);
  EXPECT_FALSE(t.damaged);
  EXPECT_EQ(splitValues(t.utf8).size(), 1u);
}

TEST(Text, UndecodableBytesShowAsTheReplacementCharacter) {
  for (const Charset& charset :
       {Charset{}, Charset{"ISO_IR 6"}, Charset{"ISO_IR 192"}, Charset{"NOT A SET"}}) {
    const DecodedText t = decodeText("M\xfcller", charset, true);
    EXPECT_TRUE(t.damaged);
    EXPECT_EQ(t.utf8, "M\xEF\xBF\xBDller");
  }
  EXPECT_TRUE(decodeText("\x1bZZ", {"", "ISO 2022 IR 87"}, true).damaged);
  EXPECT_TRUE(decodeText("\x1b$B;", {"", "ISO 2022 IR 87"}, true).damaged);  // half a character
}

TEST(Text, PaddingAndGroups) {
  expectText("Doe^John  ", {}, "Doe^John");
  expectText("Doe^John\0"s, {}, "Doe^John");
  expectText("^^^^", {}, "^^^^");
  expectText("A==", {}, "A");
  expectText("=B", {}, "=B");  // an empty first group is information
  EXPECT_EQ(splitValues("a \\ b\\\\c"), (std::vector<std::string>{"a", "b", "", "c"}));
  EXPECT_TRUE(splitValues("").empty());
}

}  // namespace
}  // namespace vernier
