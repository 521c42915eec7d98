// Rows that are kept while they are found.

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <data/row_store.hpp>
#include <filesystem>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <support/files/temporary_folder.hpp>
#include <vector>

namespace {

constexpr std::size_t rows = 5, size = 3;
const tactnet::file_metadata settings{{"data", "1234"}, {"trunk", "any"}};

std::vector<float> row_of(std::size_t row) {
    std::vector<float> values(size);
    std::iota(values.begin(), values.end(), static_cast<float>(10 * row));
    return values;
}
void write_rows(const std::filesystem::path& path, std::size_t count) {
    row_store store(path, settings, rows, size, false);
    static_cast<void>(store.look());
    for (std::size_t i = 0; i < count; ++i)
        store.write(i, row_of(i));
    store.flush();
}
std::string text_of(const std::filesystem::path& path) {
    const auto bytes = tactnet::read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct state {
    row_store::found found;
    std::vector<std::size_t> missing;
    std::size_t damaged;
    friend bool operator==(const state&, const state&) = default;
};
state state_of(const std::filesystem::path& path, const tactnet::file_metadata& of = settings,
               bool is_ours = false) {
    row_store store(path, of, rows, size, is_ours);
    const row_store::found found = store.look();
    for (std::size_t i = 0; i < rows; ++i) {
        const bool missing =
            std::find(store.missing().begin(), store.missing().end(), i) != store.missing().end();
        std::vector<float> values(size);
        if (missing)
            CHECK_THROWS_AS(store.read(i, values), tactnet::file_error);
        else
            store.read(i, values);
        CHECK((missing || values == row_of(i)));
    }
    return {found, store.missing(), store.damaged()};
}

using enum row_store::found;

} // namespace

TEST_SUITE("program") {
    TEST_CASE("row_store: what was written is there, wherever the file was cut") {
        const support::temporary_folder folder;
        const auto path = folder / "rows";
        CHECK(state_of(path) == state{nothing, {0, 1, 2, 3, 4}, 0});
        CHECK(state_of(path) == state{these_rows, {0, 1, 2, 3, 4}, 0});
        write_rows(path, 2);
        CHECK(state_of(path) == state{these_rows, {2, 3, 4}, 0});
        write_rows(path, rows);
        const std::string whole = text_of(path);
        const std::size_t head = whole.find('\n') + 1, each = (whole.size() - head) / rows;
        REQUIRE(head + rows * each == whole.size());
        for (std::size_t length = 0; length <= whole.size(); ++length) {
            tactnet::write_file(path, std::string_view(whole).substr(0, length));
            const state found = state_of(path);
            CAPTURE(length);
            CHECK(found.damaged == 0);
            if (length < head)
                CHECK(found.found == nothing);
            else
                CHECK(found.missing.size() == rows - (length - head) / each);
            write_rows(path, rows); // as if it had never been cut
            REQUIRE(text_of(path) == whole);
        }
    }

    TEST_CASE("row_store: a damaged byte is reported, and costs its row alone") {
        const support::temporary_folder folder;
        const auto path = folder / "rows";
        write_rows(path, rows);
        const std::string whole = text_of(path);
        const std::size_t head = whole.find('\n') + 1, each = (whole.size() - head) / rows;
        for (std::size_t place = 0; place < whole.size(); ++place) {
            std::string bytes = whole;
            bytes[place] = static_cast<char>(bytes[place] ^ 0x10);
            tactnet::write_file(path, bytes);
            CAPTURE(place);
            if (place < head)
                CHECK(state_of(path, settings, true) == state{others, {0, 1, 2, 3, 4}, 0});
            else
                CHECK(state_of(path) == state{these_rows, {(place - head) / each}, 1});
        }
    }

    TEST_CASE("row_store: rows of something else are begun anew, other files are not touched") {
        const support::temporary_folder folder;
        const auto path = folder / "rows";
        write_rows(path, rows);
        CHECK(state_of(path, {{"data", "1235"}, {"trunk", "any"}}) == state{others, {0, 1, 2, 3, 4}, 0});
        tactnet::write_file(path, std::string_view("someone's"));
        std::string error;
        try {
            static_cast<void>(state_of(path));
        } catch (const tactnet::file_error& caught) {
            error = caught.what();
        }
        CHECK(error == path.string() + ": expected a file of features, or none, found another file");
        CHECK(text_of(path) == "someone's");
        CHECK_THROWS_AS(row_store(folder.path(), settings, rows, size, true), tactnet::file_error);
    }
}
