#include "evaluation/stored_split.hpp"

#include "methods/training_settings.hpp"
#include "number_options.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/text/quoting.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <optional>

namespace {

/// A number in the metadata of a file that `tactnet train` wrote.
template <class Read>
auto number_in(const std::string& file, const tactnet::file_metadata& metadata, const char* key,
               const char* expected, Read read) {
    const auto found = metadata.find(key);
    if (found == metadata.end())
        throw tactnet::file_error(file, fmt::format("metadata '{}'", key),
                                  "that of a training, or --images all", "none");
    const auto value = read(found->second);
    if (!value)
        throw tactnet::file_error(file, fmt::format("metadata '{}'", key), expected,
                                  tactnet::in_quotes(found->second));
    return *value;
}

} // namespace

tactnet::data_split stored_split(const std::string& file, const tactnet::file_metadata& metadata,
                                 const std::string& folder, const image_data& data) {
    const auto share_in = [&](const char* key) {
        return number_in(file, metadata, key, "a share from 0 to below 1", [](const std::string& text) {
            const auto value = number_of(text);
            return value && is_share(*value) ? value : std::nullopt;
        });
    };
    const std::uint64_t seed =
        number_in(file, metadata, "seed", "a whole number below 2^64", whole_number_of);
    const tactnet::split_shares shares{share_in("validation_share"), share_in("test_share")};
    if (!is_share(shares.validation + shares.test))
        throw tactnet::file_error(
            file, "metadata", "shares that leave some images for training",
            fmt::format("{} to validate and {} to test", shares.validation, shares.test));
    const auto split = metadata.find("split"), trained_on = metadata.find("data");
    if (split == metadata.end() || trained_on == metadata.end())
        throw tactnet::file_error(file, "metadata", "'split' and 'data' of a training, or --images all",
                                  "none");
    if (trained_on->second != data.fingerprint)
        throw tactnet::file_error(
            folder, "",
            fmt::format("the images that {} was trained on (fingerprint {}), or --images all", file,
                        trained_on->second),
            fmt::format("others ({})", data.fingerprint));
    return tactnet::split_data(data.images.labels, data.images.classes.size(), split_rule_of(split->second),
                               seed, shares);
}
