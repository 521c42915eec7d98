// The program `tactnet_stream` from outside, with a network of random weights.

#include <tactnet/io.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
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

/// Of random weights.
tactnet::model<network> write_network(const std::filesystem::path& path,
                                      const tactnet::file_metadata& more = {}) {
    tactnet::model<network> model;
    tactnet::initialise(model.network, tactnet::he_normal{}, 3);
    for (std::size_t c = 0; c < network::outputs; ++c)
        model.classes.push_back("object" + std::to_string(c));
    tactnet::file_metadata metadata{{"network", "tactnet6"}};
    metadata.insert(more.begin(), more.end());
    tactnet::save_model(path, model, metadata);
    return model;
}

/// A count or none, a blot in the middle for a touch, and a row that is stuck.
std::string frame_of(bool touch, std::size_t number, bool broken) {
    std::string counts;
    for (std::size_t row = 0; row < 28; ++row)
        for (std::size_t column = 0; column < 50; ++column) {
            const auto dy = static_cast<double>(row) - 14, dx = static_cast<double>(column) - 25;
            const double pressure = touch ? std::max(0.0, 120 - 2 * (dy * dy + dx * dx)) : 0;
            const std::size_t noise = (number * 7 + row * 3 + column) % 5 == 0;
            counts += static_cast<char>(
                broken && row == 5 ? 255 : static_cast<int>(pressure) + static_cast<int>(noise));
        }
    return counts;
}

/// Five frames of air, then `touches` times 20 of air and 10 of a touch, and ten of air.
std::string life_of(std::size_t touches, bool broken) {
    std::string all;
    std::size_t number = 0;
    for (int i = 0; i < 5; ++i)
        all += frame_of(false, number++, false);
    for (std::size_t touch = 0; touch < touches; ++touch) {
        for (int i = 0; i < 20; ++i)
            all += frame_of(false, number++, broken);
        for (int i = 0; i < 10; ++i)
            all += frame_of(true, number++, broken);
    }
    for (int i = 0; i < 10; ++i)
        all += frame_of(false, number++, broken);
    return all;
}

} // namespace

TEST_SUITE("stream") {
    TEST_CASE("stream: once air is learnt, touches begin and end, and a broken row is found") {
        const support::temporary_folder folder;
        write_network(folder / "net");
        const std::string command = TACTNET_STREAM_PROGRAM + (" " + (folder / "net").string());
        for (const bool broken : {false, true}) {
            tactnet::write_file(folder / "stream", life_of(2, broken));
            const auto found = run_program(command + " --air 5 --json <" + (folder / "stream").string());
            CHECK(found.status == 0);
            CHECK(found.error.empty());
            std::istringstream lines(found.out);
            std::size_t number = 5, begun = 0, touching = 0, faulty = 0;
            bool before = false;
            for (std::string line; std::getline(lines, line);) {
                CHECK(line.starts_with("{\"frame\":" + std::to_string(++number) + ",\"touching\":"));
                CHECK(line.ends_with("}"));
                const bool now = line.find("\"touching\":true") != std::string::npos;
                CHECK(now == (line.find("\"label\":\"object") != std::string::npos));
                begun += now && !before;
                touching += now;
                before = now;
                faulty = 0;
                for (std::size_t at = 0; (at = line.find("\"kind\":\"stuck\"", at)) != std::string::npos;
                     ++at)
                    ++faulty;
            }
            CHECK(number == 75);
            CHECK(begun == 2);
            CHECK(touching >= 18);
            CHECK(touching <= 24);
            CHECK(faulty == (broken ? 50 : 0));
        }
        // The same as lines: number, label, probability, area, faulty tactels, microseconds.
        const auto lines = run_program(command + " --air 5 <" + (folder / "stream").string());
        CHECK(lines.out.find("6\t-\t0.0000\t0\t0\t") != std::string::npos);
        CHECK(lines.out.find("\t50\t") != std::string::npos);
        const auto picture = run_program(command + " --air 5 --picture <" + (folder / "stream").string());
        CHECK(picture.status == 0);
        CHECK(picture.out.starts_with("\x1b[2J\x1b[H\x1b[38;2;"));
        CHECK(picture.out.find("frame 6  nothing touches  area 0") != std::string::npos);
        const auto alone = run_program(command + " --picture <" + (folder / "stream").string());
        CHECK(alone.out.find("frame 1  object") != std::string::npos);
    }

    TEST_CASE("stream: probabilities are at the temperature of the weight file") {
        const support::temporary_folder folder;
        write_network(folder / "net");
        write_network(folder / "sure", {{"temperature", "0.25"}});
        tactnet::write_file(folder / "stream", frame_of(true, 0, false));
        const auto probability = [&](const char* weights) {
            const auto found = run_program(TACTNET_STREAM_PROGRAM + (" " + (folder / weights).string()) +
                                           " <" + (folder / "stream").string());
            std::istringstream line(found.out);
            std::string number, label;
            double value = 0;
            line >> number >> label >> value;
            return value;
        };
        CHECK(probability("sure") > probability("net"));
    }

    TEST_CASE("stream: frames are played at a rate, and a sensor that stops is waited for") {
        const support::temporary_folder folder;
        write_network(folder / "net");
        const std::string command = TACTNET_STREAM_PROGRAM + (" " + (folder / "net").string());
        tactnet::write_file(folder / "stream",
                            frame_of(true, 0, false) + frame_of(true, 1, false) + frame_of(true, 2, false));
        const auto start = std::chrono::steady_clock::now();
        CHECK(run_program(command + " --rate 10 <" + (folder / "stream").string()).status == 0);
        CHECK(std::chrono::steady_clock::now() - start >= std::chrono::milliseconds(200));

        const std::string file = (folder / "stream").string();
        const auto paused = run_program("(cat " + file + "; sleep 1.5; cat " + file + ") | " + command);
        CHECK(paused.status == 0);
        CHECK(labels_of(paused.out).size() == 6);
        CHECK(paused.error.find("no frame for a second\n") != std::string::npos);
        CHECK(paused.error.find("the stream goes on after 1.") != std::string::npos);
    }

    TEST_CASE("stream: a recording at its own pace") {
        const support::temporary_folder folder;
        write_network(folder / "net");
        std::string text = "DATA_TYPE MOVIE\r\nVERSION 6.10I\r\nROWS 28\r\nCOLS 50\r\nSECONDS_PER_FRAME "
                           "0.15\r\nSTART_FRAME 1\r\n"
                           "END_FRAME 3\r\nUNITS raw\r\nASCII_DATA @@\r\n";
        for (const char* seconds : {"0.0", "0.15", "0.3"}) {
            int sum = 0;
            std::string rows;
            const std::string counts = frame_of(true, 0, false);
            for (std::size_t i = 0; i < counts.size(); ++i) {
                const auto count = static_cast<int>(static_cast<unsigned char>(counts[i]));
                sum += count;
                rows += std::to_string(count) + (i % 50 == 49 ? "\r\n" : ",");
            }
            text += "\r\nFrame " + std::to_string(1 + (seconds[2] == '1') + 2 * (seconds[2] == '3')) + ", " +
                    seconds + ",, 1/2/2019 6:21PM,,,Raw Sum=,," + std::to_string(sum) + "\r\n" + rows;
        }
        tactnet::write_file(folder / "r.csv", text + "@@\r\n");
        const std::string command = TACTNET_STREAM_PROGRAM + (" " + (folder / "net").string());
        const auto start = std::chrono::steady_clock::now();
        const auto played =
            run_program(command + " recording --paced --json <" + (folder / "r.csv").string());
        CHECK(std::chrono::steady_clock::now() - start >= std::chrono::milliseconds(300));
        CHECK_MESSAGE(played.status == 0, played.error);
        CHECK(played.out.find("{\"frame\":3,\"seconds\":0.3,\"label\":") != std::string::npos);

        tactnet::write_file(folder / "cut.csv", text.substr(0, text.size() / 2));
        const auto cut = run_program(command + " recording <" + (folder / "cut.csv").string());
        CHECK(cut.status == 2);
        CHECK(labels_of(cut.out).size() == 1);
        CHECK(std::count(cut.error.begin(), cut.error.end(), '\n') == 1);
    }

    TEST_CASE("stream: bad arguments") {
        const std::string program = TACTNET_STREAM_PROGRAM;
        for (const auto& [given, sentence] : std::vector<std::pair<std::string, std::string>>{
                 {"", "expected a weight file"},
                 {"net --air", "expected a number of frames behind --air, found the end"},
                 {"net --air 0", "--air: expected a number of frames from 1 to 1000000, found '0'"},
                 {"net --air -5", "found '-5'"},
                 {"net --rate 0", "--rate: expected frames per second from 0.001 to 1000000, found '0'"},
                 {"net --rate nan", "found 'nan'"},
                 {"net --rate 1e999", "found '1e999'"},
                 {"net --paced", "--paced: expected a recording, which has times"},
                 {"net --fast", "unknown option '--fast'"},
                 {"net other", "expected 'own' or 'recording' behind the weights, found 'other'"},
                 {"net own own", "found 'own'"}}) {
            const std::string command = program + ' ' + given + " </dev/null";
            const auto found = run_program(command);
            CAPTURE(command);
            CHECK(found.status == 2);
            CHECK_MESSAGE(found.error.find(sentence) != std::string::npos, found.error);
            CHECK(found.error.find("usage: tactnet_stream") != std::string::npos);
        }
    }

    TEST_CASE("stream: frames of a plain stream and of one's own device, and damage") {
        const support::temporary_folder folder;
        const auto model = write_network(folder / "net");

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
        const auto damage = run(" own", damaged);
        CHECK(damage.status == 2);
        CHECK(labels_of(damage.out).size() == 2);
        CHECK(damage.error.find("byte 1404, frame 2: expected a sum of zero, found 1") != std::string::npos);
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
        CHECK(help.out.starts_with("usage: tactnet_stream [options] WEIGHTS [own | recording] <STREAM\n"));
        CHECK(run_program(program + " /no/such/file </dev/null").error.find("expected a file") !=
              std::string::npos);
        const auto full = run(" >/dev/full", plain);
        CHECK(full.status == 2);
        CHECK(full.error.find("standard output: expected to write all results") != std::string::npos);
    }
}
