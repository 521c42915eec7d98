#include "evaluation/results.hpp"

#include "data/regular_file.hpp"
#include "reports/report.hpp"

#include <tactnet/io/file.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cmath>
#include <cstddef>
#include <fcntl.h>
#include <numeric>
#include <stdexcept>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace {

using nlohmann::json;

std::string line_of(const training_result& r) {
    std::vector<std::size_t> counts;
    for (std::size_t truth = 0; truth < r.confusion.classes(); ++truth)
        for (std::size_t c = 0; c < r.confusion.classes(); ++c)
            counts.push_back(r.confusion(truth, c));
    nlohmann::ordered_json line;
    line["settings"] = r.settings;
    line["accuracy"] = r.confusion.accuracy();
    line["validation_accuracy"] = std::isfinite(r.validation_accuracy)
                                      ? nlohmann::ordered_json(r.validation_accuracy)
                                      : nlohmann::ordered_json(nullptr);
    line["epochs"] = r.epochs;
    line["seconds"] = r.seconds;
    line["images_per_second"] = r.images_per_second;
    line["classes"] = r.confusion.classes();
    line["confusion"] = counts;
    return tactnet::with_checksum(line.dump()) + '\n';
}

/// nlohmann::json turns any number into the type that is asked for.
std::size_t count_in(const json& value) {
    if (!value.is_number_unsigned())
        throw std::runtime_error("expected a whole number from 0, found " + value.dump());
    return value.get<std::size_t>();
}

training_result result_of(const std::string& text) {
    const json line = json::parse(text);
    training_result r;
    r.settings = line.at("settings").get<tactnet::file_metadata>();
    const json& validation = line.at("validation_accuracy");
    r.validation_accuracy = validation.is_null() ? std::nan("") : validation.get<double>();
    r.epochs = count_in(line.at("epochs"));
    r.seconds = line.at("seconds");
    r.images_per_second = line.at("images_per_second");
    const std::size_t classes = count_in(line.at("classes"));
    std::vector<std::size_t> counts;
    for (const json& count : line.at("confusion"))
        counts.push_back(count_in(count));
    if (classes > 100'000 || counts.size() != classes * classes ||
        std::accumulate(counts.begin(), counts.end(), 0.0) > 1e8)
        throw std::runtime_error("the confusion matrix does not have classes x classes counts");
    r.confusion = tactnet::confusion_matrix(classes);
    for (std::size_t i = 0; i < counts.size(); ++i)
        for (std::size_t n = 0; n < counts[i]; ++n)
            r.confusion.add(i / classes, i % classes);
    return r;
}

/// A file that other programs may write to as well; while it is open, it is this one's alone.
class locked_file {
public:
    /// Throws std::system_error, as all functions do.
    explicit locked_file(const std::filesystem::path& path)
        : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
        check(descriptor_);
        int locked = 0;
        while ((locked = ::flock(descriptor_, LOCK_EX)) != 0 && errno == EINTR)
            ;
        if (locked != 0) {
            const int error = errno;
            ::close(descriptor_);
            throw std::system_error(error, std::generic_category());
        }
    }
    locked_file(const locked_file&) = delete;
    locked_file& operator=(const locked_file&) = delete;
    ~locked_file() { ::close(descriptor_); }

    /// Appends a line that ends in a line feed, on the disk when this returns. The beginning of a line that
    /// was never finished is cut off first: whoever wrote it has failed or is dead, or it would hold the
    /// lock.
    void add_line(std::string_view line) {
        check(::ftruncate(descriptor_, end_of_last_line()));
        const ssize_t written = ::write(descriptor_, line.data(), line.size());
        check(written);
        if (written != static_cast<ssize_t>(line.size())) // a full disk takes what it can
            throw std::system_error(ENOSPC, std::generic_category());
        check(::fsync(descriptor_));
    }

private:
    static void check(ssize_t result) {
        if (result < 0)
            throw std::system_error(errno, std::generic_category());
    }

    off_t end_of_last_line() const {
        struct stat status {};
        check(::fstat(descriptor_, &status));
        off_t end = status.st_size;
        char last = 0;
        while (end > 0 && ::pread(descriptor_, &last, 1, end - 1) == 1 && last != '\n')
            --end;
        return end;
    }

    int descriptor_;
};

} // namespace

result_list::result_list(std::filesystem::path path) : path_(std::move(path)) {
    read_on();
}

std::filesystem::path result_list::claims_path() const {
    return path_.parent_path() / ".evaluation.lock";
}

void result_list::read_on() {
    std::error_code code;
    if (!std::filesystem::exists(path_, code))
        return;
    check_no_device(path_);
    if (std::filesystem::file_size(path_, code) == bytes_)
        return;
    const auto bytes = tactnet::read_file(path_);
    if (bytes.size() < bytes_ ||
        (bytes_ > 0 && bytes[bytes_ - 1] != std::byte{'\n'})) // begun anew by another
        lines_ = bytes_ = 0;
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    rest.remove_prefix(bytes_);
    for (std::size_t end = 0; (end = rest.find('\n')) != std::string_view::npos;) {
        const std::string part = fmt::format("line {}", lines_ + 1);
        std::string line(rest.substr(0, end));
        if (tactnet::detail::shows_checksum(line)) // those of earlier versions have none
            line = tactnet::check_json(line, path_.string(), part).text;
        try {
            results_.push_back(result_of(line));
        } catch (const std::exception& error) {
            throw tactnet::file_error(path_.string(), part, "a result of tactnet evaluate",
                                      fmt::format("'{}'", error.what()));
        }
        ++lines_;
        bytes_ += end + 1;
        rest.remove_prefix(end + 1);
    }
}

const training_result* result_list::find(const tactnet::file_metadata& settings) const {
    for (const training_result& r : results_)
        if (r.settings == settings)
            return &r;
    return nullptr;
}

void result_list::add(training_result result) {
    const std::string line = line_of(result);
    make_folder_of(path_);
    try {
        locked_file(path_).add_line(line);
    } catch (const std::system_error& error) {
        throw tactnet::file_error(path_.string(), "", "to add a line",
                                  fmt::format("'{}'", error.code().message()));
    }
    results_.push_back(std::move(result));
}
