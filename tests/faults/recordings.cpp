#include "scene.hpp"

#include <tactnet/io/safetensors/writer.hpp>

#include <cstddef>
#include <random>
#include <span>
#include <vector>

namespace faults {
namespace {

constexpr std::size_t frames = 4;

/// What a cell counts in a frame.
int count_of(std::size_t frame, std::size_t cell) {
    return cell % 3 == 0 ? 0 : static_cast<int>(10 + (frame * 31 + cell * 17) % 200);
}

std::string binary() {
    std::string text = "VERSION Tek API\nROWS 3\nCOLS 4\nNOISE_THRESHOLD 3\nSECONDS_PER_FRAME 0.01\n"
                       "UNITS PSI\nSTART_FRAME 1\nEND_FRAME 4\n\xBB\xBA";
    const auto number = [&](int value) {
        text += static_cast<char>(value & 0xFF);
        text += static_cast<char>(value >> 8);
    };
    for (std::size_t frame = 0; frame < frames; ++frame) {
        for (std::size_t cell = 0; cell < 12; cell += 3) { // runs of two
            number(static_cast<int>(cell + 1));
            text += '\x02';
            text += static_cast<char>(count_of(frame, cell + 1));
            text += static_cast<char>(count_of(frame, cell + 2));
        }
        number(0xFFFF);
        number(0xFFFF);
    }
    return text + "\xFF\xFE";
}

std::string text() {
    std::string all =
        "DATA_TYPE MOVIE\r\nVERSION 6.10I\r\nROWS 3\r\nCOLS 4\r\nSECONDS_PER_FRAME 0.01\r\nSTART_FRAME 1\r\n"
        "END_FRAME 4\r\nUNITS raw\r\nASCII_DATA @@\r\n";
    for (std::size_t frame = 0; frame < frames; ++frame) {
        int sum = 0;
        std::string rows;
        for (std::size_t cell = 0; cell < 12; ++cell) {
            sum += count_of(frame, cell);
            rows += std::to_string(count_of(frame, cell)) + (cell % 4 == 3 ? "\r\n" : ",");
        }
        all += "\r\nFrame " + std::to_string(frame + 1) + ", 0.0" + std::to_string(frame) +
               ",, 1/2/2019 6:21PM,,,Raw Sum=,," + std::to_string(sum) + "\r\n" + rows;
    }
    return all + "@@\r\n";
}

std::string stream_of(bool packets) {
    constexpr std::size_t cells = 28 * 50;
    std::string all;
    for (std::size_t frame = 0; frame < frames; ++frame) {
        if (packets)
            all += "TN" + std::string(1, static_cast<char>(frame));
        auto sum = static_cast<unsigned char>(frame);
        for (std::size_t i = 0; i < cells; ++i) {
            const auto count = static_cast<unsigned char>(i * (frame + 3) * 7 % 251);
            all += static_cast<char>(count);
            sum = static_cast<unsigned char>(sum ^ count);
        }
        if (packets)
            all += static_cast<char>(sum);
    }
    return all;
}

} // namespace

// A TactNet-6 for 28 x 50 counts and 22 classes, tensor by tensor: the network itself takes long to compile.
std::string network(const std::string& fourth_class) {
    tactnet::safetensors_writer writer;
    std::string classes;
    for (int c = 0; c < 22; ++c)
        classes += (c == 0 ? "[\"" : ",\"") + (c == 3 ? fourth_class : "object" + std::to_string(c)) + '"';
    writer.metadata = {{"format", "tactnet"}, {"version", "1"},     {"network", "tactnet6"},
                       {"rows", "28"},        {"columns", "50"},    {"input", "scale"},
                       {"input_scale", "1"},  {"epsilon", "1e-05"}, {"classes", classes + "]"}};
    std::mt19937 random(3);
    const auto add = [&](const std::string& name, const std::vector<std::size_t>& extents, float from,
                         float to) {
        std::size_t count = 1;
        for (const std::size_t extent : extents)
            count *= extent;
        std::vector<float> values(count);
        for (float& value : values)
            value = from + (to - from) * static_cast<float>(random() % 1000) / 1000;
        writer.add(name, extents, std::span<const float>(values));
    };
    std::size_t channels = 1;
    for (std::size_t block = 1; block <= 5; ++block) {
        const std::string number = std::to_string(block);
        const std::size_t filters = std::size_t{4} << block, side = block == 1 ? 5 : 3;
        add("conv" + number + ".weight", {filters, channels, side, side}, -0.1F, 0.1F);
        for (const char* tensor : {".weight", ".running_var"})
            add("bn" + number + tensor, {filters}, 1, 1);
        for (const std::string& tensor : {"conv" + number, "bn" + number})
            add(tensor + ".bias", {filters}, 0, 0);
        add("bn" + number + ".running_mean", {filters}, 0, 0);
        channels = filters;
    }
    add("fc.weight", {22, 256}, -0.1F, 0.1F);
    add("fc.bias", {22}, 0, 0);
    const std::vector<std::byte> bytes = writer.to_bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::map<std::string, std::string> recordings() {
    return {{"sample.fsx", binary()},
            {"sample.csv", text()},
            {"sample.mp",
             "SENSOR_TYPE NULL\r\nROWS 3\r\nCOLS 4\r\nSENSEL_AREA 1\r\nCOMMENT @@\r\n\tA map.\r\n"
             "@@\r\nSENSOR_MAP @@\r\n0, 1, 2, 3\r\n4, 5, 6, 7\r\n8, 9, 10, 11\r\n@@\r\n"},
            {"own.stream", stream_of(true)},
            {"plain.stream", stream_of(false)},
            {"stream.net", network()}};
}

} // namespace faults
