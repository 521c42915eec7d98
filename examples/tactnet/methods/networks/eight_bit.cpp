#include "methods/networks/compiled.hpp"

#include <tactnet/io/stored_deployed.hpp>

#include <fmt/format.h>

#include <utility>

namespace {

class eight_bit_network final : public trained_network {
public:
    eight_bit_network(const compiled_network& code, const compiled_eight_bit& bytes,
                      std::vector<float> folded, std::vector<std::string> classes,
                      std::string calibration = {})
        : code_(code),
          layout_(bytes.layout()),
          folded_(std::move(folded)),
          classes_(std::move(classes)),
          calibration_(std::move(calibration)),
          deployed_(bytes.deploy(folded_)) {}

    std::size_t bits() const override { return 8; }
    const std::vector<std::string>& classes() const override { return classes_; }
    std::string calibration() const override { return calibration_; }
    bool averages_reflections() const override { return true; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads,
                                 tactnet::test_time_augmentation how) const override {
        // Counts as they are.
        const std::size_t pixels = code_.pixels();
        const std::vector<float> mean(pixels);
        return tactnet::detail::evaluate(
            layout_.input, mean, 1, code_.outputs, images, chosen, how,
            [&](const tactnet::sample_batch& in, tactnet::sample_batch& out) {
                std::vector<std::uint8_t> frames;
                for (std::size_t i = 0; i < in.samples(); ++i)
                    for (std::size_t e = 0; e < pixels; ++e)
                        frames.push_back(static_cast<std::uint8_t>(in(i, e)));
                const std::vector<float> found = logits_of(*deployed_, code_, frames, threads);
                for (std::size_t i = 0; i < in.samples(); ++i)
                    out.set(i, std::span(found).subspan(i * code_.outputs, code_.outputs));
            });
    }
    std::vector<scored_class> recognise(std::span<const std::uint8_t> images,
                                        const tactnet::temperature_scaling& scaling,
                                        tactnet::thread_pool& threads) const override {
        return classes_of_rows(logits_of(*deployed_, code_, images, threads), code_.outputs, classes_.size(),
                               scaling);
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        tactnet::safetensors_writer writer;
        writer.metadata = metadata;
        tactnet::add_deployed(writer, layout_, folded_, classes_, selftest,
                              [&](std::span<const std::uint8_t> images) { return logits(images); });
        writer.write(path);
    }
    std::string header(const tactnet::header_description& says,
                       std::span<const std::uint8_t> frame) const override {
        return deployed_->header(says, frame);
    }
    void check_selftest(const tactnet::safetensors& file) const {
        tactnet::check_deployed(file, layout_.input, classes_.size(),
                                [&](std::span<const std::uint8_t> images) { return logits(images); });
    }

private:
    /// The outputs of the classes alone, as the network gives them.
    std::vector<float> logits(std::span<const std::uint8_t> images) const {
        tactnet::thread_pool alone;
        const std::vector<float> all = outputs_of(*deployed_, code_, images, alone);
        std::vector<float> some;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (i % code_.outputs < classes_.size())
                some.push_back(all[i]);
        return some;
    }

    const compiled_network& code_;
    tactnet::folded_layout layout_;
    std::vector<float> folded_;
    std::vector<std::string> classes_;
    std::string calibration_;
    std::unique_ptr<any_deployed> deployed_;
};

} // namespace

std::unique_ptr<trained_network>
make_eight_bit_network(const compiled_network& code, const compiled_eight_bit& bytes, const any_model& model,
                       const tactnet::labelled_images& images, std::span<const std::size_t> chosen) {
    const std::size_t pixels = code.pixels();
    std::vector<std::uint8_t> shown;
    for (const std::size_t i : chosen) {
        const auto image = images.pixels.subspan(i * pixels, pixels);
        shown.insert(shown.end(), image.begin(), image.end());
    }
    calibrated_numbers found = bytes.calibrate(model, shown);
    return std::make_unique<eight_bit_network>(
        code, bytes, std::move(found.folded), model.classes,
        fmt::format(
            "outputs differ by {:.2g} from those in single precision, by {:.2g} if weights were merely "
            "rounded (roots of mean squares, on images of the training)",
            found.output_error, found.output_error_of_rounded));
}

std::unique_ptr<trained_network> load_eight_bit_network(const compiled_network& code,
                                                        const compiled_eight_bit& bytes,
                                                        const tactnet::safetensors& file) {
    tactnet::stored_deployed stored = tactnet::read_deployed(file, bytes.layout());
    auto network =
        std::make_unique<eight_bit_network>(code, bytes, std::move(stored.folded), std::move(stored.classes));
    network->check_selftest(file);
    return network;
}

std::size_t eight_bit_parameter_bytes(const compiled_eight_bit& bytes, std::size_t classes) {
    const auto layout = bytes.layout();
    std::size_t sum = 0;
    tactnet::detail::for_each_folded(
        layout, tactnet::detail::arrays_of(layout, classes),
        [&](const auto& array, const auto& in_file, std::size_t) {
            sum += in_file.size * (array.kind == tactnet::folded_kind::weights ? 1 : sizeof(float));
        });
    return sum;
}
