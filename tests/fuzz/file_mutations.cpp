#include "tests/fuzz/file_mutations.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace cloth::test {
namespace {

using Mutation = void (*)(std::string&, Random&);

struct Range {
    size_t begin, length;
};

Range random_range(const std::string& file, Random& random, size_t longest) {
    const size_t begin = random.below(file.size());
    return {begin, std::min(1 + random.below(longest), file.size() - begin)};
}

void flip_bits(std::string& file, Random& random) {
    for (int count = random.between(1, 8); count > 0; --count)
        file[random.below(file.size())] ^= static_cast<char>(1 << random.below(8));
}

void truncate(std::string& file, Random& random) {
    file.resize(random.below(file.size()));
}

void remove_part(std::string& file, Random& random) {
    const Range range = random_range(file, random, 200);
    file.erase(range.begin, range.length);
}

void repeat_part(std::string& file, Random& random) {
    const Range range = random_range(file, random, 200);
    const std::string part = file.substr(range.begin, range.length);
    for (int count = random.between(1, 30); count > 0; --count) file.insert(range.begin, part);
}

void move_part(std::string& file, Random& random) {
    const Range range = random_range(file, random, 200);
    const std::string part = file.substr(range.begin, range.length);
    file.insert(random.below(file.size()), part);
}

void zero_part(std::string& file, Random& random) {
    const Range range = random_range(file, random, 200);
    std::fill_n(file.begin() + static_cast<std::ptrdiff_t>(range.begin), range.length, '\0');
}

void insert_noise(std::string& file, Random& random) {
    std::string noise(1 + random.below(64), ' ');
    for (char& byte : noise) byte = static_cast<char>(random.bits());
    file.insert(random.below(file.size()), noise);
}

/// Counts, indices and lengths of binary formats.
void replace_integer(std::string& file, Random& random) {
    const std::uint64_t number = random.one_of<std::uint64_t>(
        {0, 1, 0x7f, 0xff, 0x7fff, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fffffffffffffff,
         0xffffffffffffffff, 0x7fc00000, 0x7f800000, 0x7ff8000000000000, 1000000000});
    const size_t bytes = random.one_of<size_t>({1, 2, 4, 8});
    const size_t at = random.chance(0.3) ? 0 : random.below(file.size());
    std::memcpy(&file[at], &number, std::min(bytes, file.size() - at));
}

void swap_byte_order(std::string& file, Random& random) {
    const size_t at = random.chance(0.3) ? 0 : random.below(file.size());
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(at);
    const size_t bytes = std::min(random.one_of<size_t>({2, 4, 8}), file.size() - at);
    std::reverse(begin, begin + static_cast<std::ptrdiff_t>(bytes));
}

/// The number in the text that follows a random place.
Range number_after(const std::string& file, size_t from) {
    const char* const digits = "0123456789+-.eE";
    const size_t begin = file.find_first_of("0123456789", from);
    if (begin == std::string::npos) return {from, 0};
    const size_t end = file.find_first_not_of(digits, begin);
    return {begin, std::min(end, file.size()) - begin};
}

void replace_number(std::string& file, Random& random) {
    static const std::vector<std::string> numbers = {"nan",
                                                     "inf",
                                                     "-inf",
                                                     "-1",
                                                     "0",
                                                     "-0",
                                                     "1e308",
                                                     "-1e308",
                                                     "1e400",
                                                     "1e-320",
                                                     "1e39",
                                                     "2147483647",
                                                     "2147483648",
                                                     "-2147483649",
                                                     "4294967295",
                                                     "4294967297",
                                                     "18446744073709551615",
                                                     "9223372036854775807",
                                                     "99999999999999999999",
                                                     "0x10",
                                                     "1.5",
                                                     "1e9",
                                                     "100000000",
                                                     "",
                                                     ".",
                                                     "--1",
                                                     "1,5",
                                                     "1 2",
                                                     "\"7\"",
                                                     "null",
                                                     "[]",
                                                     "{}",
                                                     "true"};
    const Range number = number_after(file, random.below(file.size()));
    file.replace(number.begin, number.length, random.one_of(numbers));
}

/// A word or JSON value of another type.
void replace_word(std::string& file, Random& random) {
    static const std::vector<std::string> words = {
        "null",  "true",      "[]", "{}", "[[]]", "\"\"", "\"x\"",    "-1",
        "1e999", "{\"a\":1}", "{",  "}",  "[",    "]",    "<",        ">",
        "/>",    "\"",        "\n", "#",  "%",    "..",   "\xff\xfe", "\xc3\x28"};
    const char* const ends = " \t\r\n,:;<>[]{}\"=";
    const size_t begin = file.find_first_not_of(ends, random.below(file.size()));
    if (begin == std::string::npos) return;
    const size_t end = std::min(file.find_first_of(ends, begin), file.size());
    file.replace(begin, end - begin, random.one_of(words));
}

void nest_deeply(std::string& file, Random& random) {
    static const std::vector<std::string> openings = {"[",   "{\"a\":",      "<node>", "<a>",
                                                      "{\n", "JOINT a\n{\n", "("};
    const std::string& opening = random.one_of(openings);
    const int depth = random.one_of<int>({50, 2000, 30000});
    std::string nest;
    for (int k = 0; k < depth; ++k) nest += opening;
    file.insert(random.below(file.size()), nest);
}

void lengthen_line(std::string& file, Random& random) {
    static const std::vector<std::string> fillings = {"9", " 1", " ", "a", "1/2/3 ", "\t0.5"};
    const std::string& filling = random.one_of(fillings);
    std::string line;
    for (int k = random.between(500, 50000); k > 0; --k) line += filling;
    file.insert(random.below(file.size()), line);
}

void swap_lines(std::string& file, Random& random) {
    const auto line_at = [&](size_t place) {
        const size_t begin = place == 0 ? 0 : file.rfind('\n', place - 1) + 1;
        return Range{begin, std::min(file.find('\n', begin), file.size()) - begin};
    };
    const Range a = line_at(random.below(file.size())), b = line_at(random.below(file.size()));
    if (a.begin >= b.begin) return;
    const std::string first = file.substr(a.begin, a.length);
    const std::string second = file.substr(b.begin, b.length);
    file.replace(b.begin, b.length, first);
    file.replace(a.begin, a.length, second);
}

constexpr Mutation mutations[] = {
    flip_bits,    truncate,       remove_part,    repeat_part,    move_part,       zero_part,
    insert_noise, replace_number, replace_number, replace_number, replace_integer, swap_byte_order,
    replace_word, replace_word,   nest_deeply,    lengthen_line,  swap_lines};

}  // namespace

std::string mutated(const std::string& file, Random& random) {
    std::string result = file;
    for (int defects = random.between(1, 4); defects > 0 && !result.empty(); --defects)
        mutations[random.below(std::size(mutations))](result, random);
    return result;
}

}  // namespace cloth::test
