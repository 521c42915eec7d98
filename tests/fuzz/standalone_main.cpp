// Runs a fuzz target as a plain test, with any compiler: on its seed corpus, and on many mutated copies of
// the seeds, the same ones each time.
//
//     test_TARGET [--corpus FILE]         what a fuzzer found worth keeping belongs to the seeds
//     test_TARGET [--corpus FILE] FOLDER  write the seeds there instead, for a fuzzer
//     test_TARGET --pack FOLDER FILE      make a corpus of the files that a fuzzer left in a folder
//
// A corpus is one file: of each input its number of bytes, a new line, the bytes, a new line. All of them are
// in corpus.tar.xz, which the build unpacks into its folder tests/fuzz/corpus. After changing one there, run
// in it `tar -cJf SOURCES/tests/fuzz/corpus.tar.xz *.corpus`.

#include "fuzz_target.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <random>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace {

using input = std::vector<std::uint8_t>;

class damage {
public:
    explicit damage(std::vector<input> seeds) : seeds_(std::move(seeds)) {}

    input next() {
        input copy = seeds_[below(seeds_.size())];
        for (std::size_t changes = 1 + below(4); changes > 0; --changes)
            change(copy);
        return copy;
    }

private:
    // std::uniform_int_distribution differs between standard libraries; the engine does not.
    std::size_t below(std::size_t bound) {
        return bound == 0 ? 0 : static_cast<std::size_t>(engine_() % bound);
    }

    void change(input& bytes) {
        constexpr std::string_view alphabet = "{}[]:,\"\\/u0123456789-+.eE \n\tdtypeshape\x7f\x80\xc3\xff";
        const std::size_t at = below(bytes.size());
        const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        const auto length =
            static_cast<std::ptrdiff_t>(below(std::min<std::size_t>(bytes.size() - at, 24) + 1));
        const auto letter = [&] { return static_cast<std::uint8_t>(alphabet[below(alphabet.size())]); };
        switch (bytes.empty() ? 3 : below(9)) {
        case 0: // a bit
            *place = static_cast<std::uint8_t>(*place ^ (1U << below(8)));
            break;
        case 1: // any byte
            *place = static_cast<std::uint8_t>(below(256));
            break;
        case 2: // a byte that means something
            *place = letter();
            break;
        case 3:
            bytes.insert(place, letter());
            break;
        case 4:
            bytes.erase(place, place + length);
            break;
        case 5: { // a piece twice
            const input piece(place, place + length);
            bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size())), piece.begin(),
                         piece.end());
            break;
        }
        case 6: // cut short
            bytes.resize(at);
            break;
        case 7: { // another digit, if one follows
            const auto digit =
                std::find_if(place, bytes.end(), [](std::uint8_t b) { return b >= '0' && b <= '9'; });
            if (digit != bytes.end())
                *digit = static_cast<std::uint8_t>('0' + below(10));
            break;
        }
        default: { // a piece of another seed
            const input& other = seeds_[below(seeds_.size())];
            const std::size_t from = below(other.size());
            const std::size_t count = below(std::min<std::size_t>(other.size() - from, 40) + 1);
            bytes.insert(place, other.begin() + static_cast<std::ptrdiff_t>(from),
                         other.begin() + static_cast<std::ptrdiff_t>(from + count));
        }
        }
    }

    std::vector<input> seeds_;
    std::mt19937_64 engine_{20190419};
};

int write_seeds(const std::filesystem::path& folder, const std::vector<input>& seeds) {
    std::filesystem::create_directories(folder);
    std::size_t number = 0;
    for (const input& seed : seeds)
        tactnet::write_file(folder / ("seed" + std::to_string(number++)), std::as_bytes(std::span(seed)));
    return 0;
}

/// The files of a folder as one, in the order of their names.
int pack(const std::filesystem::path& folder, const std::filesystem::path& corpus) {
    std::set<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        files.insert(entry.path());
    std::vector<std::byte> packed;
    const auto append = [&](std::span<const std::byte> bytes) {
        packed.insert(packed.end(), bytes.begin(), bytes.end());
    };
    for (const std::filesystem::path& path : files) {
        const std::vector<std::byte> bytes = tactnet::read_file(path);
        const std::string size = std::to_string(bytes.size()) + "\n";
        append(std::as_bytes(std::span(size)));
        append(bytes);
        packed.push_back(std::byte{'\n'});
    }
    tactnet::write_file(corpus, packed);
    return 0;
}

void add_corpus(const std::filesystem::path& path, std::vector<input>& seeds) {
    const std::vector<std::byte> bytes = tactnet::read_file(path);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.empty())
        throw tactnet::file_error(path.string(), "", "one input or more", "none");
    for (std::size_t at = 0; at < text.size();) {
        std::size_t size = 0;
        const auto number = std::from_chars(text.data() + at, text.data() + text.size(), size);
        const auto begin = static_cast<std::size_t>(number.ptr - text.data()) + 1;
        if (number.ec != std::errc() || begin > text.size() || size >= text.size() - begin ||
            text[begin - 1] != '\n' || text[begin + size] != '\n')
            throw tactnet::file_error(path.string(), "byte " + std::to_string(at),
                                      "a number of bytes, and as many behind it", "something else");
        const auto first = text.begin() + static_cast<std::ptrdiff_t>(begin);
        seeds.emplace_back(first, first + static_cast<std::ptrdiff_t>(size));
        at = begin + size + 1;
    }
}

int test(const std::vector<input>& seeds) {
    if (seeds.empty()) {
        std::fprintf(stderr, "the seed corpus is empty\n");
        return 1;
    }
    constexpr std::size_t rounds = 100'000;
    fuzz_every_form = true;
    try {
        for (const input& seed : seeds) {
            LLVMFuzzerTestOneInput(seed.data(), seed.size());
            for (std::size_t size = 0; size < seed.size(); ++size)
                LLVMFuzzerTestOneInput(seed.data(), size);
        }
        damage source(seeds);
        for (std::size_t round = 0; round < rounds; ++round) {
            const input bytes = source.next();
            LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "an exception left the target: %s\n", error.what());
        return 1;
    }
    std::printf("%zu seeds and %zu mutated copies\n", seeds.size(), rounds);
    return 0;
}

} // namespace

int main(int count, char** arguments) {
    std::vector<std::string> words(arguments + 1, arguments + count);
    try {
        if (words.size() == 3 && words[0] == "--pack")
            return pack(words[1], words[2]);
        std::vector<input> seeds = fuzz_seeds();
        if (words.size() >= 2 && words[0] == "--corpus") {
            add_corpus(words[1], seeds);
            words.erase(words.begin(), words.begin() + 2);
        }
        if (words.empty())
            return test(seeds);
        if (words.size() == 1 && !words[0].starts_with("-"))
            return write_seeds(words[0], seeds);
    } catch (const std::exception& error) { // a file that cannot be read or written
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    std::fprintf(stderr, "expected nothing, --corpus FILE, a FOLDER to write to, or --pack FOLDER FILE\n");
    return 1;
}
