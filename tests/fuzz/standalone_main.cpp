// Runs a fuzz target as a plain test, with any compiler: on its seed corpus, and on many mutated copies of
// the seeds, the same ones each time. With --corpus and a folder, what a fuzzer found and kept there belongs
// to the seeds. With a folder alone it writes the seed corpus there instead.

#include "fuzz_target.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
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
        case 7: { // another digit, where there is one behind
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

int write_seeds(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    std::size_t number = 0;
    for (const input& seed : fuzz_seeds()) {
        std::ofstream file(folder / ("seed" + std::to_string(number++)), std::ios::binary);
        file.write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
        if (!file.flush())
            return 1;
    }
    return 0;
}

/// Adds the files of a folder in the order of their names; false if there are none.
bool add_corpus(const std::filesystem::path& folder, std::vector<input>& seeds) {
    std::set<std::filesystem::path> files;
    std::error_code code;
    for (const auto& entry : std::filesystem::directory_iterator(folder, code))
        files.insert(entry.path());
    for (const std::filesystem::path& path : files) {
        std::ifstream file(path, std::ios::binary);
        seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        if (file.bad() || seeds.back().empty())
            return false;
    }
    return !files.empty();
}

} // namespace

int main(int count, char** arguments) {
    if (count == 2)
        return write_seeds(arguments[1]);
    std::vector<input> seeds = fuzz_seeds();
    if (count > 2 &&
        (count != 3 || std::string_view(arguments[1]) != "--corpus" || !add_corpus(arguments[2], seeds))) {
        std::fprintf(stderr, "expected a FOLDER to write to, or --corpus and a FOLDER of files\n");
        return 1;
    }
    if (seeds.empty()) {
        std::fprintf(stderr, "the seed corpus is empty\n");
        return 1;
    }
    constexpr std::size_t rounds = 100'000;
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
