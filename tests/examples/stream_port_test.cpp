// The program `tactnet_stream` at the other end of a serial line, a pseudo-terminal: 16 × 16 tactels of 12
// bits, whose counts fall with pressure, at 100 frames per second. With TACTNET_PORT_FRAMES=60000, for ten
// minutes.

#include <tactnet/io.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <termios.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace {

using clock_type = std::chrono::steady_clock;
using network = tactnet::tactnet6<tactnet::shape{16, 16}, 22>;
constexpr std::size_t tactels = 256, air = 50;
constexpr int untouched = 2135;

/// A pseudo-terminal, whose other end has a name.
struct line {
    int file = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    std::string name;
    line() {
        REQUIRE(file >= 0);
        REQUIRE(::grantpt(file) == 0);
        REQUIRE(::unlockpt(file) == 0);
        name = ::ptsname(file);
    }
    line(const line&) = delete;
    line& operator=(const line&) = delete;
    ~line() { ::close(file); }
    void send(const std::string& bytes) const {
        REQUIRE(::write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
    }
};

/// 'A', 'U', cells of 16 bits, and the exclusive or of all that. A cell is broken from the start.
std::string packet_of(bool touch, std::size_t number) {
    std::string bytes = "AU";
    for (std::size_t i = 0; i < tactels; ++i) {
        const int y = static_cast<int>(i / 16) - 8, x = static_cast<int>(i % 16) - 8;
        const int pressure = touch ? std::max(0, 2000 - 80 * (y * y + x * x)) : 0;
        const int noise = static_cast<int>((number * 7 + i * 3) % 5);
        const auto count = static_cast<unsigned>(i == 100 ? 65535 : untouched - pressure - noise);
        bytes += static_cast<char>(count & 0xFF);
        bytes += static_cast<char>(count >> 8);
    }
    char sum = 0;
    for (const char byte : bytes)
        sum = static_cast<char>(sum ^ byte);
    return bytes + sum;
}

/// The program in the background, whose answers come through a pipe.
struct program {
    int answers = -1;
    pid_t process = -1;
    program(const std::vector<std::string>& words, const std::string& error) {
        std::array<int, 2> ends{};
        REQUIRE(::pipe(ends.data()) == 0);
        process = ::fork();
        if (process == 0) {
            ::dup2(ends[1], STDOUT_FILENO);
            ::dup2(::open(error.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
            std::vector<char*> arguments;
            for (const std::string& word : words)
                arguments.push_back(const_cast<char*>(word.c_str()));
            arguments.push_back(nullptr);
            ::execv(arguments[0], arguments.data());
            ::_exit(127);
        }
        ::close(ends[1]);
        answers = ends[0];
    }
    program(const program&) = delete;
    program& operator=(const program&) = delete;
    ~program() {
        if (process > 0)
            stop();
        ::close(answers);
    }
    /// Milliseconds for which it had a core, and how often others got it although the program wanted it.
    long stop() {
        rusage used{};
        ::kill(process, SIGTERM);
        ::wait4(std::exchange(process, -1), nullptr, 0, &used);
        return 1000 * (used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
               (used.ru_utime.tv_usec + used.ru_stime.tv_usec) / 1000 + used.ru_nivcsw;
    }
    /// Lines that come within some milliseconds; the first is waited for.
    std::string read(int milliseconds) const {
        std::array<char, 65536> text;
        pollfd input{answers, POLLIN, 0};
        if (::poll(&input, 1, milliseconds) <= 0)
            return {};
        const ssize_t got = ::read(answers, text.data(), text.size());
        return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))};
    }
};

const char* const description =
    R"({"rows": 16, "columns": 16, "cell": "uint16", "marker": "41 55", "checksum": {"kind": "xor8"},
        "offset": 2135, "inverted": true, "full_scale": 2135, "broken": [65535]})";

template <class Network = network>
void write_network(const std::filesystem::path& path, const char* name = "tactnet6") {
    tactnet::model<Network> model;
    tactnet::initialise(model.network, tactnet::he_normal{}, 3);
    for (std::size_t c = 0; c < Network::outputs; ++c)
        model.classes.push_back("object" + std::to_string(c));
    tactnet::save_model(path, model, {{"network", name}});
}

} // namespace

TEST_SUITE("stream") {
    TEST_CASE("stream: a serial line at 100 frames per second loses no frame, and is opened again") {
        std::string wait = "--json";
        SUBCASE("which sleeps while it waits") {}
        SUBCASE("which stays awake") {
            wait = "--awake";
        }
        const support::temporary_folder folder;
        write_network(folder / "net");
        tactnet::write_file(folder / "mat.json", std::string(description));
        const char* const asked = std::getenv("TACTNET_PORT_FRAMES");
        const std::size_t frames = asked != nullptr ? std::strtoul(asked, nullptr, 10) : 300;
        // What the program opens is a link, so that the line may come back under another name.
        const std::string port = (folder / "port").string();
        auto first = std::make_unique<line>();
        std::filesystem::create_symlink(first->name, port);
        program stream({TACTNET_STREAM_PROGRAM, "--sensor", (folder / "mat.json").string(), "--port", port,
                        "--speed", "921600", "--air", std::to_string(air), "--json", wait,
                        (folder / "net").string()},
                       (folder / "error").string());
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        std::string text;
        std::vector<double> microseconds;
        const auto is_touch = [](std::size_t number) { return number % 100 >= 60; };
        const auto start = clock_type::now();
        for (std::size_t number = 0; number < frames; ++number) {
            const std::string packet = packet_of(is_touch(number), number);
            std::this_thread::sleep_until(start + number * std::chrono::milliseconds(10));
            first->send(packet.substr(0, 200)); // as bytes come over a line
            std::this_thread::sleep_until(start + number * std::chrono::milliseconds(10) +
                                          std::chrono::milliseconds(3));
            const auto sent = clock_type::now(); // the program may answer before `send` returns
            first->send(packet.substr(200));
            if (number < air)
                continue;
            text += stream.read(2000);
            microseconds.push_back(
                std::chrono::duration<double, std::micro>(clock_type::now() - sent).count());
        }
        std::size_t touching = 0, labelled = 0, broken = 0;
        for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; ++at) {
            const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
            const std::string one = text.substr(begin, at - begin);
            touching += one.find("\"touching\":true") != std::string::npos;
            labelled += one.find("\"label\":\"object") != std::string::npos;
            broken += one.find("{\"row\":6,\"column\":4,\"kind\":\"broken\"") != std::string::npos;
        }
        std::ranges::sort(microseconds);
        MESSAGE(frames << " frames, from the last byte to the label: median "
                       << microseconds[microseconds.size() / 2] << " us, 99 % "
                       << microseconds[microseconds.size() * 99 / 100] << " us");
        CHECK(std::count(text.begin(), text.end(), '\n') == static_cast<std::ptrdiff_t>(frames - air));
        CHECK(broken == frames - air);
        CHECK(labelled == touching);
        CHECK(touching >= frames / 100 * 39);
        CHECK(touching <= frames / 100 * 42);
        CHECK(support::text_of(folder / "error").empty());

        // Unplugged, and plugged in again.
        first.reset();
        std::filesystem::remove(port);
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        const line second;
        std::filesystem::create_symlink(second.name, port);
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        second.send(packet_of(false, 1).substr(77)); // joined within a frame
        for (std::size_t number = 0; number < 3; ++number)
            second.send(packet_of(false, number));
        std::string more;
        for (int i = 0; i < 20 && std::count(more.begin(), more.end(), '\n') < 3; ++i)
            more += stream.read(100);
        CHECK(std::count(more.begin(), more.end(), '\n') == 3);
        const std::string error = support::text_of(folder / "error");
        CHECK_MESSAGE(error.find("is lost, and opened again when it is there") != std::string::npos, error);
        CHECK(error.find("is there again") != std::string::npos);
        if (wait == "--awake")
            CHECK(stream.stop() > static_cast<long>(frames)); // asleep, a tenth of that
    }

    TEST_CASE("stream: touches are saved as images, without a network") {
        const support::temporary_folder folder;
        tactnet::write_file(folder / "mat.json", std::string(description));
        std::string bytes;
        for (std::size_t number = 0; number < 250; ++number)
            bytes += packet_of(number >= air && number % 50 >= 30, number);
        tactnet::write_file(folder / "stream", bytes);
        std::filesystem::create_directory(folder / "cups");
        const auto found = support::run_program(
            TACTNET_STREAM_PROGRAM + (" --sensor " + (folder / "mat.json").string()) + " --air 50 --save " +
            (folder / "cups").string() + " <" + (folder / "stream").string());
        CHECK_MESSAGE(found.status == 0, found.error);
        std::vector<std::string> names;
        for (const auto& each : std::filesystem::directory_iterator(folder / "cups"))
            names.push_back(each.path().filename().string());
        std::ranges::sort(names);
        CHECK(names == std::vector<std::string>{"000103.png", "000153.png", "000203.png"});
    }

    TEST_CASE("stream: lines of digits, as a sketch prints them; a frame with a broken tactel has no label") {
        const support::temporary_folder folder;
        write_network(folder / "net");
        tactnet::write_file(folder / "lines.json",
                            std::string(R"({"rows": 16, "columns": 16, "cell": "digits", "full_scale": 1023,
                                            "broken": [-1]})"));
        std::string lines;
        for (int frame = 0; frame < 3; ++frame)
            for (int i = 0; i < 256; ++i)
                lines +=
                    (frame == 1 && i == 7 ? "-1" : std::to_string(i * 4 % 1024)) + (i < 255 ? "," : "\r\n");
        tactnet::write_file(folder / "stream", lines);
        const auto found =
            support::run_program(TACTNET_STREAM_PROGRAM + (" --sensor " + (folder / "lines.json").string()) +
                                 ' ' + (folder / "net").string() + " <" + (folder / "stream").string());
        CHECK(found.status == 2);
        CHECK(std::count(found.out.begin(), found.out.end(), '\n') == 2);
        CHECK_MESSAGE(found.error.find("frame 2 cannot be recognised") != std::string::npos, found.error);
    }

    TEST_CASE(
        "stream: the network and size of the file, and of the sensor, are those that were compiled in") {
        const support::temporary_folder folder;
        write_network(folder / "net");
        tactnet::write_file(folder / "wide.json", std::string(R"({"rows": 16, "columns": 17})"));
        const std::string command = std::string(TACTNET_STREAM_PROGRAM) + ' ' + (folder / "net").string();
        const auto other = support::run_program(command + " --sensor " + (folder / "wide.json").string());
        CHECK(other.status == 2);
        CHECK_MESSAGE(other.error.find("expected an array of 16 x 16, as the network, found 16 x 17") !=
                          std::string::npos,
                      other.error);
        write_network<tactnet::tactnet4<tactnet::shape{9, 9}, 22>>(folder / "small", "tactnet4");
        const auto missing = support::run_program(TACTNET_STREAM_PROGRAM +
                                                  (" " + (folder / "small").string()) + " </dev/null");
        CHECK(missing.status == 2);
        const auto folder_as_port = support::run_program("timeout 20 " + command + " --port /tmp");
        CHECK(folder_as_port.status == 2);
        CHECK(folder_as_port.error.find("cannot read the stream: Is a directory") != std::string::npos);
        CHECK_MESSAGE(
            missing.error.find("found tactnet4 at 9x9: build with -DTACTNET_STREAM_NETWORKS=tactnet4=9x9") !=
                std::string::npos,
            missing.error);
        CHECK(support::run_program(TACTNET_STREAM_PROGRAM + std::string(" --help"))
                  .out.find("tactnet6 at 16 x 16") != std::string::npos);
    }
}
