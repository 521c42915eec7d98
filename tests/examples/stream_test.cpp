// The program `tactnet_stream` from outside, with a network of random weights.

#include <tactnet/io.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <span>
#include <sstream>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>
#include <utility>
#include <vector>

using support::run_program;

namespace {

using network = tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>;
constexpr std::size_t frames = 3, cells = network::input_shape.size();

/// Number and label of each line; the rest must be numbers in their range.
std::vector<std::string> labels_of(const std::string& out) {
    std::vector<std::string> labels;
    std::istringstream lines(out);
    std::size_t number = 0;
    double probability = 0, microseconds = 0;
    for (std::string label; lines >> number >> label >> probability >> microseconds;) {
        labels.push_back(label);
        CHECK(number == labels.size());
        CHECK(probability >= 1 / 22.0);
        CHECK(probability <= 1);
        CHECK(microseconds > 0);
    }
    return labels;
}

} // namespace

TEST_SUITE("stream") {
    TEST_CASE("stream: frames of a plain stream and of one's own device, and damage") {
        const support::temporary_folder folder;
        tactnet::model<network> model;
        tactnet::initialise(model.network, tactnet::he_normal{}, 3);
        for (std::size_t c = 0; c < network::outputs; ++c)
            model.classes.push_back("object" + std::to_string(c));
        tactnet::save_model(folder / "net", model, {{"network", "tactnet6"}});

        std::string plain, own;
        std::vector<std::uint8_t> counts;
        for (std::size_t f = 0; f < frames; ++f) {
            own += "TN" + std::string(1, static_cast<char>(f));
            auto sum = static_cast<std::uint8_t>(f);
            for (std::size_t i = 0; i < cells; ++i) {
                counts.push_back(static_cast<std::uint8_t>(i * (f + 3) * 7 % 251));
                own += static_cast<char>(counts.back());
                sum ^= counts.back();
            }
            own += static_cast<char>(sum);
        }
        plain.assign(counts.begin(), counts.end());
        tactnet::thread_pool alone;
        const auto logits = model.logits(counts, alone);
        std::vector<std::string> expected;
        for (std::size_t f = 0; f < frames; ++f) {
            const auto row = std::span(logits).subspan(f * network::outputs, network::outputs);
            expected.push_back(std::string(tactnet::classify_logits(row, model.classes).value().name));
        }

        const std::string program = TACTNET_STREAM_PROGRAM, weights = " " + (folder / "net").string();
        const auto run = [&](const std::string& options, const std::string& stream) {
            tactnet::write_file(folder / "stream", stream);
            return run_program(program + weights + options + " <" + (folder / "stream").string());
        };
        CHECK(run("", plain).status == 0);
        CHECK(labels_of(run("", plain).out) == expected);
        CHECK(run(" own", own).status == 0);
        CHECK(labels_of(run(" own", own).out) == expected);
        CHECK(labels_of(run(" own", "noise" + own).out) == expected);

        const auto cut = run("", plain.substr(0, plain.size() - 1));
        CHECK(cut.status == 2);
        CHECK(labels_of(cut.out).size() == 2);
        CHECK(cut.error.find("expected a whole frame of 1400 bytes, found 1399 bytes of it") !=
              std::string::npos);
        std::string damaged = own;
        damaged[2000] ^= 1;
        const auto told = run(" own", damaged);
        CHECK(told.status == 2);
        CHECK(labels_of(told.out).size() == 2);
        CHECK(told.error.find("byte 1404, frame 2: expected a sum of zero, found 1") != std::string::npos);
        // A packet is not lost without a word because its first bytes are damaged: in the middle or the last.
        for (const std::size_t packet : {1u, 2u})
            for (const std::size_t byte : {0u, 1u}) {
                std::string lost = own;
                lost[packet * own.size() / frames + byte] = '?';
                const auto missed = run(" own", lost);
                CHECK(missed.status == 2);
                CHECK(labels_of(missed.out).size() == 2);
                CHECK_MESSAGE(missed.error.find("expected 'TN' in front of a packet") != std::string::npos,
                              missed.error);
            }
        // A packet that is lost, doubled or exchanged shows in the numbers of the others.
        const auto packet = [&](std::size_t f, std::size_t number) {
            std::string one = own.substr(f * own.size() / frames, own.size() / frames);
            one.back() = static_cast<char>(one.back() ^ one[2] ^ static_cast<char>(number));
            one[2] = static_cast<char>(number);
            return one;
        };
        const std::pair<std::string, std::string> broken[] = {
            {packet(0, 0) + packet(2, 2), "frame 2: expected packet number 1, found 2"},
            {packet(0, 0) + packet(0, 0) + packet(1, 1), "frame 2: expected packet number 1, found 0"},
            {packet(0, 0) + packet(2, 2) + packet(1, 1), "frame 3: expected packet number 3, found 1"}};
        for (const auto& [stream, sentence] : broken) {
            const auto found = run(" own", stream);
            CHECK(found.status == 2);
            CHECK(labels_of(found.out).size() == stream.size() / packet(0, 0).size());
            CHECK_MESSAGE(found.error.find(sentence) != std::string::npos, found.error);
        }
        const auto around = run(" own", packet(0, 254) + packet(1, 255) + packet(2, 0));
        CHECK(around.status == 0);
        CHECK(labels_of(around.out) == expected);
        CHECK(run(" own", packet(1, 7) + packet(2, 8)).status == 0); // joined late
        for (const std::string& none : {std::string(), std::string(10'000, '-')}) {
            const auto nothing = run(" own", none);
            CHECK(nothing.status == 2);
            CHECK(nothing.out.empty());
            CHECK(nothing.error.find("expected frames, found none in " + std::to_string(none.size())) !=
                  std::string::npos);
        }
        CHECK(run_program(program).status == 2);
        const auto help = run_program(program + " --help");
        CHECK(help.status == 0);
        CHECK(help.out == "usage: tactnet_stream WEIGHTS [own] <STREAM\n");
        CHECK(run_program(program + " /no/such/file </dev/null").error.find("expected a file") !=
              std::string::npos);
        const auto full = run(" >/dev/full", plain);
        CHECK(full.status == 2);
        CHECK(full.error.find("standard output: expected to write all results") != std::string::npos);
    }
}
