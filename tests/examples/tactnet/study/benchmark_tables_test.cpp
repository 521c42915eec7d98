// Tables that a study reads in addition to its own results: times of other libraries, and bytes of code.

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <study/benchmark_tables.hpp>
#include <support/files/temporary_folder.hpp>
#include <vector>

namespace {

/// What `Read` finds in a file of that text.
template <auto Read>
auto read_table(std::string_view text) {
    const support::temporary_folder folder;
    const auto path = folder / "table.csv";
    tactnet::write_file(path, text);
    return Read(path);
}

/// What its error says after the name of the file.
template <auto Read>
std::string refused_table(std::string_view text) {
    try {
        (void)read_table<Read>(text);
    } catch (const tactnet::file_error& error) {
        return error.place() + ": expected " + error.expected() + ", found " + error.found();
    }
    return "nothing";
}

/// Peers in words: "onednn of tactnet6 28x50: 37.5 us in 32 bits on A 1".
std::vector<std::string> peers_in_words(std::string_view text) {
    std::vector<std::string> words;
    for (const peer_time& t : read_table<read_peer_times>(text))
        words.push_back(fmt::format("{} of {} {}x{}: {} us in {} bits on {}", t.peer, t.method, t.rows,
                                    t.columns, t.microseconds, t.bits, t.processor));
    return words;
}
std::vector<std::string> sizes_in_words(std::string_view text) {
    std::vector<std::string> words;
    for (const code_size& s : read_table<read_code_bytes>(text))
        words.push_back(fmt::format("{} {}x{} in {} bits: {}", s.method, s.rows, s.columns, s.bits, s.bytes));
    return words;
}

constexpr auto& refused_peers = refused_table<read_peer_times>;
constexpr auto& refused_sizes = refused_table<read_code_bytes>;

} // namespace

TEST_SUITE("the program tactnet") {
    TEST_CASE("read_peer_times: single frames of all columns that are another library's microseconds") {
        using list = std::vector<std::string>;
        CHECK(peers_in_words("network,batch,tactnet_us,onednn_us,onednn_spread,tactnet_8bit_us,torch_us\n"
                             "tactnet6/28x50,1,13,37.5,0.01,7,410\n"
                             "tactnet6/28x50,64,12,30,0.01,6,90\r\n"
                             "tactnet4/7x13,1,1.3,5.25,0.02,1,120") ==
              list{"onednn of tactnet6 28x50: 37.5 us in 32 bits on ",
                   "torch of tactnet6 28x50: 410 us in 32 bits on ",
                   "onednn of tactnet4 7x13: 5.25 us in 32 bits on ",
                   "torch of tactnet4 7x13: 120 us in 32 bits on "});
        // Columns in 8 bits are recognised, and what did not run is left out.
        CHECK(peers_in_words("network,batch,tactnet_8bit_us,onednn_8bit_us,onednn_8bit_spread,torch_us\n"
                             "tactnet6/28x50,1,11.5,38.5,0.01,nan\n") ==
              list{"onednn of tactnet6 28x50: 38.5 us in 8 bits on "});
        CHECK(peers_in_words("network,batch,onednn_us,ratio,processor\ntactnet6/28x50,1,38.5,2,A 1\n") ==
              list{"onednn of tactnet6 28x50: 38.5 us in 32 bits on A 1"});
    }

    TEST_CASE("read_peer_times: refuses what is no such table, with its place") {
        const std::string head = "network,batch,onednn_us\n";
        CHECK(refused_peers("") ==
              "line 1: expected the head of a table of benchmark_inference, 'network,batch,…', found ''");
        CHECK(refused_peers("network;batch\n").starts_with("line 1: expected the head"));
        CHECK(refused_peers("network,batch,a\"b_us\n") ==
              "line 1: expected columns of letters, digits and _, found 'a\"b_us'");
        CHECK(refused_peers(head + "tactnet6/28x50,1\n") ==
              "line 2: expected 3 columns as in the head, found 'tactnet6/28x50,1'");
        for (const char* network : {"tactnet6", "tactnet6/28", "/28x50", "tactnet6/0x50", "tactnet6/28x50x3"})
            CHECK_MESSAGE(refused_peers(head + network + ",1,30\n")
                              .starts_with("line 2: expected a network and its size, such as tactnet6/28x50"),
                          network);
        for (const char* time : {"0", "-3", "inf", "1e99", "3us"})
            CHECK_MESSAGE(refused_peers(head + "tactnet4/7x13,1,5\ntactnet6/28x50,1," + time + "\n")
                              .starts_with("line 3: expected microseconds above 0 of onednn, found '"),
                          time);
    }

    TEST_CASE("read_code_bytes: networks, sizes, bits and bytes") {
        CHECK(sizes_in_words(
                  "network,bits,bytes\ntactnet6/28x50,32,30303\r\ntactnet6-economical/7x13,8,9000\n") ==
              std::vector<std::string>{"tactnet6 28x50 in 32 bits: 30303",
                                       "tactnet6-economical 7x13 in 8 bits: 9000"});
    }

    TEST_CASE("read_code_bytes: refuses what is no such table, with its place") {
        const std::string head = "network,bits,bytes\n";
        CHECK(refused_sizes("network,bytes\n")
                  .starts_with("line 1: expected the head of a table of the target"));
        CHECK(refused_sizes(head + "tactnet6,32,5\n") ==
              "line 2: expected a network and its size, such as tactnet6/28x50, found 'tactnet6'");
        CHECK(refused_sizes(head + "tactnet6/28x50,32\n").starts_with("line 2: expected 3 columns"));
        CHECK(refused_sizes(head + "tactnet6/28x50,16,5\n") ==
              "line 2: expected 8 or 32 bits of a weight, found '16'");
        for (const char* bytes : {"0", "-1", "1e3", ""})
            CHECK_MESSAGE(refused_sizes(head + "tactnet6/28x50,32," + bytes + "\n") != "nothing", bytes);
    }
}
