// tactnet sensor: what a recording, or some seconds of a device, looks like, and a description to start from.

#include "commands/commands.hpp"

#include <tactnet/sensors/any_recording.hpp>
#include <tactnet/sensors/described/description_file.hpp>
#include <tactnet/sensors/described/guess.hpp>
#include <tactnet/sensors/recording.hpp>
#include <tactnet/sensors/tekscan/equilibration.hpp>

#include <cmath>
#include <recording_file.hpp>

namespace {

/// Prints the frames of a recording in numbers.
void print_frames(const tactnet::recording& all) {
    const tactnet::recording_description& d = all.description;
    print(fmt::format("{}: {} frames of {} x {}\n", printable(d.format), all.size(), d.rows, d.columns));
    if (all.damage)
        print(fmt::format("damaged: {}\n", printable(all.damage->message())));
    float least = 0, most = 0;
    std::size_t broken = 0;
    bool any = false;
    for (std::size_t frame = 0; frame < all.size(); ++frame)
        for (const float cell : all[frame].cells) {
            if (std::isnan(cell)) {
                ++broken;
                continue;
            }
            least = any ? std::min(least, cell) : cell;
            most = any ? std::max(most, cell) : cell;
            any = true;
        }
    if (any)
        print(fmt::format("{} from {} to {}\n",
                          d.unit == tactnet::pressure_unit::pascal ? "pascals" : "counts", least, most));
    if (broken > 0)
        print(fmt::format("{} broken cells in all frames\n", broken));
    if (any && d.unit == tactnet::pressure_unit::raw && least > 0)
        print("no cell is ever zero: state the count of an untouched cell as 'offset', and 'inverted' if "
              "counts fall "
              "under pressure\n");
}

int look_at(const std::filesystem::path& file, const std::filesystem::path& sensor) {
    const std::vector<std::byte> bytes = read_recording_file(file);
    if (!sensor.empty()) {
        const tactnet::recording all =
            tactnet::decode_all(tactnet::any_recording(tactnet::read_sensor(sensor)), bytes);
        print_frames(all);
        return all.damage ? bad_input : success;
    }
    const tactnet::recording known = tactnet::decode_all(tactnet::any_recording(), bytes);
    if (!known.description.format.empty()) {
        print_frames(known);
        print("programs recognise this format by its content: it needs no description\n");
        return known.damage ? bad_input : success;
    }
    if (known.damage && known.damage->found.starts_with("an equilibration")) {
        const auto even = tactnet::read_equilibration(file);
        print(fmt::format("{}: gains of {} x {} cells\n", even.description.format, even.description.rows,
                          even.description.columns));
        return success;
    }
    const auto guess = tactnet::guess_sensor(bytes);
    if (!guess) {
        tell("tactnet: {}: expected a recording, lines of numbers or packets that repeat, found none\n",
             printable(file.string()));
        return bad_input;
    }
    print_frames(tactnet::decode_all(tactnet::any_recording(*guess), bytes));
    print(fmt::format("a description to start from; check rows, columns and the order of the cells:\n{}\n",
                      tactnet::sensor_json(*guess)));
    return success;
}

} // namespace

command add_sensor(CLI::App& program) {
    struct options {
        std::filesystem::path file, sensor;
    };
    const auto given = std::make_shared<options>();
    CLI::App* const subcommand = program.add_subcommand(
        "sensor", "Says what a recording or a device looks like, and proposes a description");
    subcommand->add_option("file", given->file, "A recording, or some seconds of a device")->required();
    subcommand->add_option("--sensor", given->sensor, "A description to read the file by (JSON)");
    return [given] { return look_at(given->file, given->sensor); };
}
