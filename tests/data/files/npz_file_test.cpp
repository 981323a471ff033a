#include "data/files/npz_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>

#include "data/core/errors.h"
#include "tests/data/files/npz_writer.h"

namespace cloth::npz_file_test {

using namespace cloth::test;

namespace {

using Numbers = std::vector<double>;

std::string path_of(const char* name) {
    return testing::TempDir() + name;
}

template <class Action>
std::string refusal(const Action& action) {
    try {
        action();
    } catch (const LoadError& error) {
        return error.what();
    }
    return "";
}

bool says(const std::string& text, const std::string& what) {
    return text.find(what) != std::string::npos && text.find("Remedy") != std::string::npos;
}

NpyArray parse(const std::string& bytes) {
    return parse_npy(bytes, "file.npz", "array a");
}

TEST(NpyArray, ReadsEveryTypeOfNumber) {
    const std::vector<std::int64_t> shape = {3};
    const Numbers expected = {1, 2, 100};
    const auto numbers = [&](const char* descr, const auto& values) {
        return parse(npy(descr, shape, bytes_of(values))).numbers;
    };
    EXPECT_EQ(numbers("<f8", std::vector<double>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("<f4", std::vector<float>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("<i8", std::vector<std::int64_t>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("<u8", std::vector<std::uint64_t>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("<i4", std::vector<std::int32_t>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("<u4", std::vector<std::uint32_t>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("<i2", std::vector<std::int16_t>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("<u2", std::vector<std::uint16_t>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("|i1", std::vector<std::int8_t>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("|u1", std::vector<std::uint8_t>{1, 2, 100}), expected);
    EXPECT_EQ(numbers("|b1", std::vector<std::uint8_t>{1, 0, 1}), (Numbers{1, 0, 1}));
    EXPECT_EQ(numbers("<i4", std::vector<std::int32_t>{-1, -2, 7}), (Numbers{-1, -2, 7}));
    EXPECT_EQ(parse(npy(">u2", {2}, std::string("\1\2\0\3", 4))).numbers, (Numbers{258, 3}));
    std::string big = bytes_of(std::vector<double>{1.5});
    std::reverse(big.begin(), big.end());
    EXPECT_EQ(parse(npy(">f8", {}, big)).numbers, Numbers{1.5});
}

TEST(NpyArray, PutsTheOrderOfFortranIntoThatOfC) {
    // a[i][j][k] = 100 i + 10 j + k of shape 2 x 3 x 2; Fortran's first index runs fastest.
    Numbers c, fortran;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 2; ++k) c.push_back(100 * i + 10 * j + k);
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 2; ++i) fortran.push_back(100 * i + 10 * j + k);
    const NpyArray a = parse(npy("<f8", {2, 3, 2}, bytes_of(c))),
                   b = parse(npy("<f8", {2, 3, 2}, bytes_of(fortran), /*fortran=*/true));
    EXPECT_EQ(a.shape, (std::vector<std::int64_t>{2, 3, 2}));
    EXPECT_EQ(a.numbers, c);
    EXPECT_EQ(b.numbers, c);
}

TEST(NpyArray, ReadsTextAndEmptyArrays) {
    const NpyArray wide = parse(npy("<U4", {}, std::string("m\0\0\0a\0\0\0l\0\0\0e\0\0\0", 16)));
    EXPECT_TRUE(wide.is_text);
    EXPECT_EQ(wide.text, "male");
    EXPECT_EQ(parse(npy("|S8", {}, std::string("female\0\0", 8))).text, "female");
    EXPECT_EQ(parse(npy("<f8", {0, 3}, "")).size(), 0);
}

TEST(NpyArray, RefusesWhatItCannotRead) {
    const std::string data = bytes_of(Numbers{1, 2, 3, 4});
    EXPECT_TRUE(says(refusal([&] { parse(npy("|O", {4}, data)); }), "Python objects"));
    EXPECT_TRUE(says(refusal([&] { parse(npy("<f8", {5}, data)); }), "cut off"));
    EXPECT_TRUE(says(refusal([&] { parse(npy("<f8", {1 << 30, 1 << 30, 1 << 30}, data)); }), ""));
    EXPECT_TRUE(says(refusal([&] { parse(npy("<c16", {2}, data)); }), "c16"));
    EXPECT_TRUE(says(refusal([&] { parse(npy("<f2", {2}, data)); }), "f2"));
    EXPECT_TRUE(says(refusal([&] { parse("something else entirely"); }), "array a"));
    EXPECT_TRUE(says(refusal([&] { parse(npy("<f8", {4}, data).substr(0, 40)); }), "header"));
    EXPECT_TRUE(says(refusal([&] { load_npy(path_of("no such.npy")); }), "no such.npy"));
}

TEST(NpzFile, FindsArraysByNameCompressedOrNot) {
    const std::string path = path_of("arrays.npz");
    for (const bool compressed : {true, false}) {
        write_npz(path,
                  {{"a", npy({2, 2}, Numbers{1, 2, 3, 4})},
                   {"gender", npy("|S4", {}, "male")},
                   {"rate", npy({}, std::vector<float>{120})},
                   {"pickled", npy("|O", {1}, "?")}},
                  compressed);
        const NpzFile file(path);
        EXPECT_EQ(file.names(), (std::vector<std::string>{"a", "gender", "pickled", "rate"}));
        EXPECT_EQ(file.numbers("a", 2).numbers, (Numbers{1, 2, 3, 4}));
        EXPECT_EQ(file.number("rate"), 120.0);
        EXPECT_EQ(file.text("gender"), "male");
        EXPECT_FALSE(file.has("b"));
    }
    std::filesystem::remove(path);
}

TEST(NpzFile, ErrorsNameFileAndArray) {
    const std::string path = path_of("wrong.npz");
    write_npz(path, {{"a", npy({2, 2}, Numbers{1, 2, 3, 4})},
                     {"nan", npy({1}, Numbers{std::numeric_limits<double>::quiet_NaN()})},
                     {"pickled", npy("|O", {1}, "?")}});
    const NpzFile file(path);
    const auto expect = [&](const std::string& text, const char* array, const char* problem) {
        for (const std::string& word : {path, std::string("array ") + array, std::string(problem)})
            EXPECT_TRUE(says(text, word)) << text;
    };
    expect(refusal([&] { file.array("b"); }), "b", "missing");
    expect(refusal([&] { file.numbers("a", 1); }), "a", "2 axes");
    expect(refusal([&] { file.numbers("nan", 1); }), "nan", "not finite");
    expect(refusal([&] { file.number("a"); }), "a", "single number");
    expect(refusal([&] { file.text("a"); }), "a", "text");
    expect(refusal([&] { file.array("pickled"); }), "pickled", "Python objects");
    std::filesystem::remove(path);
}

TEST(NpzFile, DamagedFilesAreRefused) {
    const std::string path = path_of("damaged.npz");
    write_npz(path, {{"a", npy({200}, Numbers(200, 1.25))}}, /*compressed=*/false);
    std::string bytes;
    {
        std::ifstream file(path, std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(file), {});
    }
    bytes[400] = static_cast<char>(bytes[400] ^ 1);
    std::ofstream(path, std::ios::binary) << bytes;
    EXPECT_TRUE(says(refusal([&] { NpzFile(path).array("a"); }), "check sum"));
    std::ofstream(path, std::ios::binary) << "no archive";
    EXPECT_TRUE(says(refusal([&] { NpzFile file(path); }), path));
    write_npz(path, {});
    EXPECT_TRUE(says(refusal([&] { NpzFile file(path); }), path));
    std::filesystem::remove(path);
    EXPECT_TRUE(says(refusal([&] { NpzFile file(path); }), path));
}

}  // namespace

}  // namespace cloth::npz_file_test
