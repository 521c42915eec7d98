// tactnet simulate: makes labelled images where there is no sensor, as a folder with one subfolder a class.

#include "commands/commands.hpp"
#include "commands/scenes.hpp"
#include "data/input_file.hpp"
#include "files/output_files.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/simulation/paper/objects.hpp>
#include <tactnet/version.hpp>

#include <atomic>
#include <decode_image.hpp>
#include <interrupt.hpp>
#include <mutex>
#include <thread>

namespace {

using tactnet::simulation::paper_objects;

struct simulate_options {
    std::string out, scene = "paper";
    std::size_t per_class = 50, threads = std::max(1u, std::thread::hardware_concurrency());
    std::uint64_t seed = 1;
};

/// Throws usage_error where the folder's note says anything else.
void check_note(const std::filesystem::path& note, const std::string& says) {
    check_no_device(note);
    const auto bytes = tactnet::read_file(note, std::size_t{1} << 20);
    const std::string_view found(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (found != says + '\n')
        refuse("{}: expected images of the same simulation, {}, or another folder, found {}", note.string(),
               says, tactnet::in_quotes(found, 200));
}

/// But for what a killed simulation left where no locks show that it is dead.
bool is_as_good_as_empty(const std::filesystem::path& folder) {
    std::error_code code;
    const std::filesystem::directory_iterator entries(folder, code);
    return !code && std::all_of(begin(entries), end(entries), [](const auto& entry) {
        return tactnet::is_partial_file_name(entry.path().filename().string());
    });
}

/// A folder begun with the same settings is continued, any other left alone. The note that says them comes
/// first, so that whatever ends the program later leaves a folder to go on with.
void claim_folder(const simulate_options& o) {
    const std::filesystem::path folder = o.out, note = folder / "simulation.json";
    const std::string says =
        nlohmann::json{{"scene", o.scene},
                       {"seed", o.seed},
                       {"images per class", o.per_class},
                       {"library", fmt::format("{}.{}.{}", TACTNET_VERSION_MAJOR, TACTNET_VERSION_MINOR,
                                               TACTNET_VERSION_PATCH)}}
            .dump();
    std::error_code code;
    tactnet::remove_abandoned_files(folder);
    if (std::filesystem::exists(note, code)) {
        check_note(note, says);
    } else {
        if (folder.empty() ||
            (std::filesystem::exists(folder, code) &&
             (!std::filesystem::is_directory(folder, code) || !is_as_good_as_empty(folder))))
            refuse("{}expected a new folder, an empty one, or one that a simulation has begun, found {}",
                   folder.empty() ? "" : o.out + ": ", folder.empty() ? "no name" : "something else");
        make_folder_of(note);
        tactnet::write_file(note, says + '\n');
    }
    for (const auto& family : paper_objects)
        make_folder_of(folder / family.name / "image");
}

int simulate(const simulate_options& o) {
    const simulated_scene& scene = *std::ranges::find(simulated_scenes(), o.scene, &simulated_scene::name);
    claim_folder(o);
    catch_interrupts();
    tactnet::thread_pool threads(o.threads);
    stopwatch watch;
    progress shown;
    std::mutex mutex; // of what follows
    std::size_t done = 0, unsettled = 0;
    std::atomic<bool> stop = false;
    const std::size_t all = o.per_class * paper_objects.size();
    const auto make = [&](const simulator& simulates, std::size_t index) {
        const std::size_t family = index % paper_objects.size(), number = index / paper_objects.size();
        const auto file =
            std::filesystem::path(o.out) / paper_objects[family].name / fmt::format("{:05}.png", number + 1);
        bool settled = true;
        if (!std::filesystem::exists(file)) {
            const simulated_image image = simulates(family, o.seed, static_cast<std::uint32_t>(number));
            write_png(file, scene.rows, scene.columns, image.counts);
            settled = image.settled;
        }
        const std::lock_guard lock(mutex);
        unsettled += !settled;
        ++done;
        shown.show(
            fmt::format("{} of {} images, {}", done, all, time_left(watch.seconds(), done, all - done)),
            done == all);
    };
    threads.on_each_thread([&](auto share) {
        try {
            const simulator simulates = scene.make();
            for (std::size_t index = share.begin(all); index < share.end(all) && !stop && !interrupted();
                 ++index)
                make(simulates, index);
        } catch (...) { // the pool passes it on once all have ended
            stop = true;
            throw;
        }
    });
    shown.end_line();
    if (done < all) {
        tell("stopped after {} of {} images; the same command goes on\n", done, all);
        return interrupted_by_user;
    }
    if (unsettled > 0)
        tell("{} images: the contact did not settle, and is the best that was found\n", unsettled);
    print(fmt::format("{}: {} images of {} classes in {}\n", printable(o.out), all, paper_objects.size(),
                      duration_text(watch.seconds())));
    return success;
}

} // namespace

command add_simulate(CLI::App& program) {
    auto* app = program.add_subcommand("simulate", "Simulate labelled images of the paper's 22 classes");
    auto o = std::make_shared<simulate_options>();
    app->add_option("--out", o->out,
                    "Folder to write: one subfolder per class, each with 28 x 50 8-bit PNG images")
        ->type_name("FOLDER")
        ->required();
    add_option(*app, "--per-class", o->per_class, whole_number(1, 100'000), "Images of each class");
    add_option(*app, "--seed", o->seed, whole_number(0),
               "Seed of all random draws; the same seed gives bit-identical images");
    std::vector<std::string> names;
    std::string says = "What is simulated:";
    for (const simulated_scene& scene : simulated_scenes()) {
        says += fmt::format("{} '{}' {}", names.empty() ? "" : ";", scene.name, scene.says);
        names.emplace_back(scene.name);
    }
    add_option(*app, "--scene", o->scene, CLI::IsMember(names), says);
    add_option(*app, "--threads", o->threads, whole_number(1, 1024),
               "Number of threads; the images do not depend on it (default: one per core)");
    return [o] { return simulate(*o); };
}
