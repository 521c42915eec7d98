#include "data/image_data.hpp"

#include "console.hpp"
#include "data/input_file.hpp"

#include <tactnet/image/resize.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/described/description_file.hpp>
#include <tactnet/text/message.hpp>

#include <decode_image.hpp>
#include <sstream>
#include <system_error>

namespace {

tactnet::grey_image resized(const tactnet::grey_image& image, std::size_t rows, std::size_t columns) {
    return {rows, columns, tactnet::resize_bicubic(image.pixels, image.rows, image.columns, rows, columns)};
}

/// As long as all have one size.
void keep_as_taken(image_data& data, const tactnet::grey_image& image) {
    const tactnet::shape size{image.rows, image.columns};
    if (data.taken.pixels.empty())
        data.taken.size = size;
    if (size == data.taken.size)
        data.taken.pixels.insert(data.taken.pixels.end(), image.pixels.begin(), image.pixels.end());
}

} // namespace

void tell_left_out(const tactnet::image_folder& list) {
    for (const std::string& name : list.left_out)
        tell("{} is left out, since its name begins with a dot\n", printable((list.root / name).string()));
}

void paper_fingerprint::add(std::size_t label, std::size_t rows, std::size_t columns,
                            std::span<const std::uint8_t> pixels) {
    fingerprint print;
    print.add(rows);
    print.add(columns);
    print.mix_all(pixels);
    sums_[label] += print.value();
}

bool paper_fingerprint::of_paper() const {
    std::uint64_t all = 0;
    for (const std::uint64_t sum : sums_) {
        fingerprint print;
        print.add(sum);
        all += print.value();
    }
    return all == 0x587e7229c6307ee5;
}

std::string image_data::name(std::size_t image) const {
    return printable(images.paths[image].lexically_relative(root).string());
}

bool image_data::of_paper() const {
    const bool reduced = !taken.pixels.empty();
    const std::size_t height = reduced ? taken.size.rows : images.rows,
                      width = reduced ? taken.size.columns : images.columns;
    const std::span<const std::uint8_t> pixels = reduced ? taken.pixels : images.pixels;
    paper_fingerprint print(images.classes.size());
    for (std::size_t i = 0; i < images.size(); ++i)
        print.add(images.labels[i], height, width, pixels.subspan(i * height * width, height * width));
    return print.of_paper();
}

std::optional<double> image_reading::full_scale() const {
    if (sensor.empty())
        return std::nullopt;
    check_no_device(sensor);
    const auto full = tactnet::read_sensor(sensor).full_scale;
    if (!full)
        throw tactnet::file_error(sensor, "field 'full_scale'", "the count that becomes 255", "none");
    return full;
}

tactnet::grey_image in_bytes(const grey_counts& counts, std::optional<double> full_scale,
                             const std::filesystem::path& file) {
    if (counts.largest > 255 && !full_scale)
        throw tactnet::file_error(file.string(), counts.kind,
                                  "8 bits per channel, or --sensor FILE, a description with their full_scale",
                                  counts.largest == 65535 ? "16 bits" : "other numbers");
    const double scale = counts.largest > 255 ? 255 / *full_scale : 1;
    tactnet::grey_image image{counts.rows, counts.columns, {}};
    for (const float count : counts.pixels)
        image.pixels.push_back(static_cast<std::uint8_t>(std::min(255.0, count * scale + 0.5)));
    return image;
}

image_data load_data(const std::filesystem::path& folder, std::size_t rows, std::size_t columns,
                     const image_reading& how, const group_options& groups) {
    image_list listed = list_images(folder, groups);
    const tactnet::image_folder& list = listed.folder;
    tell_left_out(list);
    image_data data;
    data.root = folder;
    data.groups = std::move(listed.groups);
    data.group_names = std::move(listed.group_names);
    data.given = std::move(listed.given);
    fingerprint of_groups, of_parts;
    for (const std::size_t group : data.groups)
        of_groups.add(group);
    if (data.given)
        for (const auto* part : {&data.given->training, &data.given->validation, &data.given->test}) {
            of_parts.add(part->size());
            for (const std::size_t image : *part)
                of_parts.add(image);
        }
    data.groups_fingerprint = of_groups.text(), data.given_fingerprint = of_parts.text();
    const auto decode = [full = how.full_scale()](const std::filesystem::path& path) {
        return in_bytes(decode_counts(path), full, path);
    };
    data.images = how.resize ? tactnet::load_images(list, rows, columns, decode,
                                                    [&](const tactnet::grey_image& image) {
                                                        keep_as_taken(data, image);
                                                        return resized(image, rows, columns);
                                                    })
                             : tactnet::load_images(list, rows, columns, decode);
    if (data.taken.pixels.size() != data.images.size() * data.taken.size.size()) // not all have that size
        data.taken = {};
    fingerprint taken, print;
    taken.mix_all(data.taken.pixels);
    data.taken.fingerprint = taken.text();
    print.add(rows);
    print.add(columns);
    for (const std::string& name : data.images.classes)
        print.add(name);
    for (const std::size_t label : data.images.labels)
        print.add(label);
    print.mix_all(data.images.pixels);
    data.fingerprint = print.text();
    return data;
}

tactnet::grey_image load_image(const std::filesystem::path& path, std::size_t rows, std::size_t columns,
                               const image_reading& how, std::optional<double> full_scale) {
    check_no_device(path);
    tactnet::grey_image image = in_bytes(decode_counts(path), full_scale, path);
    if (image.rows == rows && image.columns == columns)
        return image;
    if (!how.resize)
        refuse("{}: expected {} x {} pixels (rows x columns), or --resize, found {} x {}", path.string(),
               rows, columns, image.rows, image.columns);
    return resized(image, rows, columns);
}

std::vector<std::string> load_class_names(const std::filesystem::path& path) {
    std::error_code code;
    if (std::filesystem::is_directory(path, code))
        return tactnet::list_image_folder(path, image_extensions).classes;
    check_no_device(path);
    const auto bytes = tactnet::read_file(path, std::size_t{1} << 20);
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!tactnet::is_utf8(text))
        refuse("{}: expected class names in UTF-8, a line each, found other bytes", path.string());
    std::vector<std::string> names;
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF"; // of editors on Windows
    std::istringstream lines(text.substr(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0));
    for (std::string line; std::getline(lines, line);) {
        if (line.ends_with('\r'))
            line.pop_back();
        if (line.empty())
            continue;
        names.push_back(line);
    }
    if (const std::string problem = tactnet::detail::problem_of_names(names); !problem.empty())
        refuse("{}: expected {}, found {}", path.string(), tactnet::detail::expected_names, problem);
    if (names.empty())
        refuse("{}: expected class names, a line each, found none", path.string());
    return names;
}
