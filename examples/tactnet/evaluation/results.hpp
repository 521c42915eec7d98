#pragma once

// Finished trainings of an evaluation, in a file of JSON lines that grows by one as each is done. What is in
// there need not be done again.

#include "data/image_data.hpp"
#include "files/line_file.hpp"
#include "methods/method.hpp"

#include <tactnet/decision/probabilities.hpp>
#include <tactnet/training/metrics.hpp>

#include <limits>

/// A temperature fitted to results on images that were not trained on. Nothing without such images, and for
/// methods without probabilities.
std::optional<tactnet::temperature_scaling> fit_temperature(const tactnet::evaluation& held_out,
                                                            std::span<const std::size_t> images,
                                                            const image_data& data);

/// How well the probabilities of a network agree with how often it is right.
struct calibration {
    tactnet::temperature_scaling scaling{};
    /// On the test images, by the softmax and by the scaled one; empty for methods without probabilities.
    tactnet::reliability_diagram before{}, after{};
};

calibration calibration_of(const tactnet::evaluation& result, std::span<const std::size_t> images,
                           const image_data& data, const tactnet::temperature_scaling& scaling);

struct training_result {
    tactnet::file_metadata settings; ///< see describe_training and describe_trials
    tactnet::confusion_matrix confusion;
    double validation_accuracy = 0; ///< NaN without such images
    double training_accuracy = 0;   ///< on images as they are
    /// On test images, averaged over their reflections; NaN for methods that do not do that.
    double reflected_accuracy = std::numeric_limits<double>::quiet_NaN();
    /// At a temperature fitted on the validation images; nothing for methods without probabilities.
    std::optional<::calibration> calibration{};
    double seconds = 0;
    std::size_t epochs = 0;
};

/// The settings of the same training in single precision.
tactnet::file_metadata in_single_precision(tactnet::file_metadata settings);

class result_list {
public:
    /// Reads what there is. Throws tactnet::file_error.
    explicit result_list(std::filesystem::path path);

    /// The result of a training with just these settings, or nothing.
    const training_result* find(const tactnet::file_metadata& settings) const;
    /// Whether a training with these settings is done: also in single precision, if it is one in 8 bits.
    bool has(const tactnet::file_metadata& settings) const {
        return find(settings) != nullptr && find(in_single_precision(settings)) != nullptr;
    }
    /// The result of the same training by another version or for another instruction set, or nothing.
    const training_result* find_elsewhere(const tactnet::file_metadata& settings) const;
    /// How many results in single precision are of no training that is wanted, whoever made it, and in which
    /// settings they differ; empty without any.
    std::string others(const std::vector<tactnet::file_metadata>& wanted) const;
    /// Reads what other programs have added since. Throws tactnet::file_error.
    void read_on();
    /// Keeps a result, on the disk before anything else. Other programs may add to the same file.
    void add(training_result result);

    const std::filesystem::path& path() const { return file_.path(); }

private:
    void keep(training_result result);

    line_file file_;
    std::map<tactnet::file_metadata, training_result> results_; ///< by their settings
    /// The settings without version and instruction set of each, and where it is in `results_`.
    std::map<tactnet::file_metadata, tactnet::file_metadata> elsewhere_;
};
