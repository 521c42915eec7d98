#include "methods/trunks/features.hpp"

#include "console.hpp"
#include "data/input_file.hpp"
#include "files/claims.hpp"
#include "files/output_files.hpp"
#include "methods/description.hpp"

#include <tactnet/io/pretrained.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/transfer/networks.hpp>

#include <functional>
#include <interrupt.hpp>

namespace {

/// An image as it is, and mirrored at its rows (bit 0 of `view`) and at its columns (bit 1).
std::vector<std::uint8_t> mirrored(std::span<const std::uint8_t> image, tactnet::extent2d size,
                                   std::size_t view) {
    std::vector<std::uint8_t> result;
    for (std::size_t y = 0; y < size.rows; ++y)
        for (std::size_t x = 0; x < size.columns; ++x)
            result.push_back(image[((view & 1U) != 0 ? size.rows - 1 - y : y) * size.columns +
                                   ((view & 2U) != 0 ? size.columns - 1 - x : x)]);
    return result;
}

} // namespace

method_costs feature_finder::costs() const {
    method_costs all = trunk->costs;
    all.multiply_adds *= views();
    all.multiply_adds_on_pixels *= views();
    return all;
}

pretrained_file feature_finder::file() const {
    return {trunk->network, trunk->arrays().list.front().name, trunk->costs.parameter_bytes};
}

tactnet::file_metadata feature_finder::describe() const {
    return {{"features", fmt::format("{} of {}", trunk->features, trunk->network.title)},
            {"photograph", fmt::format("{}x{}", trunk->photograph.rows, trunk->photograph.columns)},
            {"pooling", pooled ? "maximum and average" : "none"},
            {"reflections", pooled ? "all four" : "none"},
            {"input", "scale"},
            {"input_scale", "1"}}; // the features include how counts are scaled
}

std::vector<float> feature_finder::find(const loaded_trunk& network, std::span<const std::uint8_t> images,
                                        std::span<const std::size_t> chosen, tactnet::thread_pool& threads,
                                        const std::function<bool(std::size_t)>& proceed) const {
    const std::size_t pixels = trunk->photograph.size(), values = trunk->map.size(),
                      channels = trunk->map.channels;
    const std::size_t most = std::min(together, chosen.size());
    std::vector<float> rows(chosen.size() * size()), photographs(most * pixels), maps(most * values),
        found(channels);
    for (std::size_t first = 0; first < chosen.size() && proceed(first); first += most) {
        const auto some = chosen.subspan(first, std::min(most, chosen.size() - first));
        for (std::size_t view = 0; view < views(); ++view) {
            threads.for_each(some.size(), [&](std::size_t i) {
                const auto own = mirrored(images.subspan(some[i] * image.area(), image.area()), image, view);
                tactnet::to_photograph(own, image, photograph,
                                       {trunk->photograph.rows, trunk->photograph.columns},
                                       std::span(photographs).subspan(i * pixels, pixels));
            });
            if (!network(threads, std::span(photographs).first(some.size() * pixels),
                         std::span(maps).first(some.size() * values)))
                throw std::runtime_error(fmt::format("expected finite features of {}, found some that are "
                                                     "not: its weights are broken",
                                                     trunk->network.title));
            for (std::size_t i = 0; i < some.size(); ++i) {
                const auto map = std::span<const float>(maps).subspan(i * values, values);
                const auto row = std::span(rows).subspan((first + i) * size(), size());
                if (!pooled) {
                    std::ranges::copy(map, row.begin());
                    continue;
                }
                const auto largest = row.first(channels), mean = row.subspan(channels);
                tactnet::pool_features(tactnet::feature_pooling::maximum, map, trunk->map, found);
                for (std::size_t c = 0; c < channels; ++c)
                    largest[c] = view == 0 ? found[c] : std::max(largest[c], found[c]);
                tactnet::pool_features(tactnet::feature_pooling::average, map, trunk->map, found);
                for (std::size_t c = 0; c < channels; ++c)
                    mean[c] = (view == 0 ? 0 : mean[c]) + found[c] / static_cast<float>(views());
            }
        }
    }
    return rows;
}

frame_work feature_finder::work(std::function<void(std::span<const float>)> use) const {
    return [finder = *this, network = trunk->seeded(), use = std::move(use),
            images = std::vector<std::uint8_t>()](std::size_t frames) mutable {
        if (images.size() != frames * finder.image.area())
            images = made_up_touches(frames, finder.image);
        tactnet::thread_pool alone;
        use(finder.find(network, images, tactnet::all_samples(frames), alone));
    };
}

void trunk_features::open(std::shared_ptr<tactnet::safetensors_source> file, std::string prefix) {
    file_ = std::move(file), prefix_ = std::move(prefix);
    finder_.photograph = tactnet::stored_photograph_preprocessing(*file_, prefix_);
    tactnet::require_pretrained(*file_, tactnet::with_prefix(finder_.trunk->arrays(), prefix_),
                                finder_.trunk->behind, prefix_);
}

std::shared_ptr<pretrained_weights> trunk_features::pretrained(const feature_finder& finder,
                                                               const std::filesystem::path& path) {
    auto features = std::make_shared<trunk_features>(finder);
    features->open(std::make_shared<tactnet::safetensors_source>(tactnet::safetensors_source::open(path)),
                   "");
    return features;
}

void trunk_features::load(const weight_file& file) {
    if (!file.trunk)
        refuse("{}: expected arrays of {}, whose names begin with '{}', found none", file.arrays.file(),
               finder_.trunk->network.title, trunk_prefix);
    open(file.trunk, std::string(trunk_prefix));
}

const loaded_trunk& trunk_features::network() const {
    const std::lock_guard lock(mutex_);
    if (!network_)
        network_ = finder_.trunk->load(*finder_.trunk, *file_, prefix_);
    return network_;
}

std::vector<float> trunk_features::rows(std::span<const std::uint8_t> images,
                                        std::span<const std::size_t> chosen,
                                        tactnet::thread_pool& threads) const {
    if (images.data() != kept_images_.data() || images.size() != kept_images_.size())
        return finder_.find(network(), images, chosen, threads);
    const std::size_t size = finder_.size();
    std::vector<float> result;
    result.reserve(chosen.size() * size);
    for (const std::size_t image : chosen) {
        const auto row = std::span(kept_).subspan(image * size, size);
        result.insert(result.end(), row.begin(), row.end());
    }
    return result;
}

std::vector<float> trunk_features::read_kept(const std::filesystem::path& path,
                                             const tactnet::file_metadata& settings,
                                             std::size_t images) const {
    std::error_code code;
    if (!std::filesystem::exists(path, code))
        return {};
    try {
        const auto file = tactnet::safetensors::read(path);
        require_metadata(file, settings);
        file.require_extents("features", std::vector{images, finder_.size()});
        if (file.checksum() == tactnet::checksum_state::verified)
            return file.values<float>("features");
    } catch (const tactnet::file_error&) { // reported below
    }
    tell("{}: features of something else, or damaged; all are found anew\n", printable(path.string()));
    return {};
}

bool trunk_features::prepare(const image_data& data, const std::filesystem::path& folder,
                             tactnet::thread_pool& threads) {
    tactnet::file_metadata settings = finder_.describe();
    settings["rows"] = fmt::to_string(finder_.image.rows);
    settings["columns"] = fmt::to_string(finder_.image.columns);
    settings["data"] = data.fingerprint;
    settings["pretrained"] = pretrained_fingerprint(file_->file());
    settings.merge(describe_program());
    const std::filesystem::path path =
        folder / fmt::format("{}_{}x{}_{}.features", finder_.trunk->network.name, finder_.image.rows,
                             finder_.image.columns, fingerprint_of(settings));
    const std::size_t count = data.images.size();
    claims alone;
    kept_images_ = {}; // until all of its rows are there
    kept_.clear();
    if (!folder.empty()) {
        make_folder_of(path);
        if (!wait_until([&] { return alone.take(path); },
                        "waiting for the features that another program finds, " + printable(path.string())))
            return false;
        kept_ = read_kept(path, settings, count);
    }
    if (kept_.empty()) {
        progress line;
        const stopwatch watch;
        const auto proceed = [&](std::size_t done) {
            if (done > 0)
                line.show(fmt::format("{} features of {} of {} images, {}", finder_.trunk->network.title,
                                      done, count, time_left(watch.seconds(), done, count - done)),
                          done == count);
            return !interrupted();
        };
        kept_ = finder_.find(network(), data.images.pixels, tactnet::all_samples(count), threads, proceed);
        if (!proceed(count))
            return false;
        if (!folder.empty()) {
            tactnet::safetensors_writer writer;
            writer.metadata = settings;
            writer.add("features", {count, finder_.size()}, std::span<const float>(kept_));
            writer.write(path);
        }
    }
    kept_images_ = data.images.pixels;
    const std::lock_guard lock(mutex_);
    network_ = nullptr; // which may be large; other images load it again
    return true;
}

void trunk_features::save(tactnet::safetensors_writer& writer) const {
    const auto add = [&](const std::string& name) {
        const auto& entry = file_->at(prefix_ + name);
        writer.add(std::string(trunk_prefix) + name, entry.type, entry.extents,
                   [this, stored = prefix_ + name](const auto& take) {
                       const std::lock_guard lock(mutex_);
                       file_->read_bytes(stored, take);
                   });
    };
    for (const auto& array : finder_.trunk->arrays().list)
        add(array.name);
    if (file_->contains(prefix_ + "input_mean"))
        add("input_mean");
}
