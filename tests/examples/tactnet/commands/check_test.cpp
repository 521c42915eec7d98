// tactnet check: folders of images that are right, and that are not.

#include "../workshop.hpp"

#include <png.h>

using namespace support;

namespace {

outcome check(const workshop& shop, const fs::path& data) {
    return shop.run({"check", "--data", data.string()});
}
/// Columns of a table are as wide as need be: any number of spaces counts as one.
bool shows(const outcome& found, std::string_view text) {
    std::string narrow = found.out;
    narrow.erase(
        std::unique(narrow.begin(), narrow.end(), [](char a, char b) { return a == ' ' && b == ' '; }),
        narrow.end());
    return narrow.find(text) != std::string::npos;
}
void write_image(const fs::path& path, std::uint8_t first, std::uint8_t others, std::size_t height = rows) {
    std::vector<std::uint8_t> pixels(height * columns, others);
    pixels.front() = first;
    write_png(path, height, columns, pixels);
}

/// Counts of 16 bits, `factor` times those of the file.
void write_deeper(const fs::path& from, const fs::path& to, unsigned factor) {
    const tactnet::grey_image flat = decode_image(from);
    std::vector<std::uint16_t> counts;
    for (const std::uint8_t pixel : flat.pixels)
        counts.push_back(static_cast<std::uint16_t>(pixel * factor));
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(flat.columns);
    image.height = static_cast<png_uint_32>(flat.rows);
    image.format = PNG_FORMAT_LINEAR_Y;
    REQUIRE(png_image_write_to_file(&image, to.c_str(), 0, counts.data(), 0, nullptr) != 0);
}

} // namespace

TEST_SUITE("program") {
    TEST_CASE("check: what is in a folder, where nothing is wrong") {
        const workshop shop;
        const outcome found = check(shop, shop.data());
        CHECK_MESSAGE(found.status == 0, found.out);
        CHECK(found.error.empty());
        const std::vector<std::string> lines = lines_of(found.out);
        REQUIRE(lines.size() == 8);
        CHECK(lines[0] == "class           images  size  copies  with 255");
        CHECK(lines[2] == "left                12  7x13       0         0");
        CHECK(lines[5] == "all                 36  7x13       0         0");
        CHECK(lines[6].starts_with("These are not the paper's 1 100 images of 22 classes, 28x50, "));
        CHECK(lines[7] == "nothing is wrong");
    }

    TEST_CASE("check: many images of 16 bits are one line, with a hint") {
        const workshop shop;
        constexpr unsigned char deep[] = {
            0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
            0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x10, 0x00, 0x00, 0x00,
            0x00, 0x6a, 0xee, 0x47, 0x16, 0x00, 0x00, 0x00, 0x0b, 0x49, 0x44, 0x41, 0x54, 0x78,
            0x9c, 0x63, 0x60, 0x64, 0x02, 0x00, 0x00, 0x07, 0x00, 0x04, 0x76, 0x49, 0xe3, 0x28,
            0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82}; // 1 x 1
        for (const char* name : {"left/image3.png", "left/image4.png", "right/image5.png"})
            tactnet::write_file(shop.data() / name, std::as_bytes(std::span(deep)));
        const outcome found = check(shop, shop.data());
        CHECK(found.status == 1);
        CHECK(shows(
            found,
            "\nleft/image3.png: expected 8 bits per channel, or --sensor FILE, a description with their "
            "full_scale, found 16 bits, and so of 2 other images; the largest count is "));
        CHECK(!shows(found, "image4.png"));
        CHECK(found.out.ends_with("\n3 problems\n"));
    }

    TEST_CASE(
        "check: counts of 16 bits by their own full scale, which train, evaluate and classify read too") {
        const workshop shop;
        const fs::path flat = shop / "flat.png";
        fs::copy(shop.data(), shop / "flat", fs::copy_options::recursive);
        fs::copy_file(shop.image(), flat);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < images_per_class; ++i)
                write_deeper(shop.image(c, i), shop.image(c, i), 16);
        const outcome blind = check(shop, shop.data());
        CHECK(blind.status == 1);
        CHECK(shows(blind, " and so of 35 other images; the largest count is 30"));
        CHECK(blind.out.ends_with("\n36 problems\n"));
        const words train("train --rows 7 --columns 13 --method tactnet4 --epochs 2 --output"),
            sensor("--sensor mat.json");
        shop.refuses(train + words("w.safetensors --data DATA"),
                     "a description with their full_scale, found 16 bits");
        const auto describe = [&](const std::string& more) {
            tactnet::write_file(shop / "mat.json", "{\"rows\": 7, \"columns\": 13" + more + "}");
            return shop.run(words("check --data DATA") + sensor);
        };
        says(describe("").error, "field 'full_scale': expected the count that becomes 255, found none");
        const outcome full = describe(", \"full_scale\": 160"); // below most of the counts
        CHECK(full.status == 1);
        CHECK(shows(full, " size copies at full scale\n"));
        CHECK(shows(full, "\nall 36 7x13 0 36\n"));
        CHECK(shows(full, "pressed tactels at 160\n"));
        const outcome right = describe(", \"full_scale\": 4080");
        CHECK_MESSAGE(right.status == 0, right.out);

        shop.succeeds(train + words("deep.safetensors --data DATA") + sensor);
        shop.succeeds(train + words("flat.safetensors --data flat"));
        CHECK(shop.text("deep.safetensors") == shop.text("flat.safetensors"));
        const auto test = [&](const words& data) {
            return shop.succeeds(words("evaluate --weights flat.safetensors --results results --data") + data)
                .out;
        };
        CHECK(test(words("DATA") + sensor) == test("flat"));
        const auto answer = [&](const words& image) {
            const std::string out = shop.succeeds(words("classify --weights flat.safetensors") + image).out;
            return out.substr(out.find(','));
        };
        const std::string head = "{'descr': '<u2', 'fortran_order': False, 'shape': (7, 13), }";
        std::string array = std::string("\x93NUMPY\1\0", 8) + static_cast<char>(head.size()) + '\0' + head;
        for (const unsigned pixel : decode_image(flat).pixels)
            array += {static_cast<char>(16 * pixel & 0xFF), static_cast<char>(16 * pixel >> 8)};
        tactnet::write_file(shop / "a.npy", array);
        const std::string known = answer({flat.string()});
        for (const char* image : {"IMAGE", "a.npy"})
            CHECK(answer(words(image) + sensor) == known);
    }

    TEST_CASE("check: each image that is wrong is named, with what is wrong") {
        const workshop shop;
        const std::string whole = text_of(shop.data() / "left/image3.png");
        tactnet::write_file(shop.data() / "left/image3.png", whole.substr(0, whole.size() / 2));
        tactnet::write_file(shop.data() / "left/image4.png", std::string("no image"));
        write_image(shop.data() / "left/image5.png", 7, 7);
        write_image(shop.data() / "right/image5.png", 7, 7); // no copy of the other one
        write_image(shop.data() / "right/image6.png", 0, 255);
        write_image(shop.data() / "right/image7.png", 9, 0, rows + 1);
        fs::copy_file(shop.data() / "left/image0.png", shop.data() / "right/image12.png");
        const outcome found = check(shop, shop.data());
        CHECK(found.status == 1);
        CHECK(shows(found, "\nleft 12 7x13, unreadable 0 0\n"));
        CHECK(shows(found, "\nright 13 7x13, 8x13 1 1\n"));
        CHECK(shows(found, "\nleft/image3.png: expected "));
        CHECK(shows(
            found,
            "\nleft/image4.png: expected a JPEG or PNG image, found a file that begins with 'no image'\n"));
        for (const char* empty : {"left/image5.png", "right/image5.png"})
            CHECK(shows(found, std::string("\n") + empty +
                                   ": expected a touch, found the same value in all tactels\n"));
        CHECK(shows(found, "\nright/image6.png: expected pressures that the sensor can tell, found 90 of 90 "
                           "pressed tactels at 255\n"));
        CHECK(shows(found, "\nright/image7.png: expected 7x13 as most images, or --resize in training, found "
                           "8x13\n"));
        CHECK(shows(found, "\nright/image12.png: expected an image of one class, found a copy of "
                           "left/image0.png\n"));
        CHECK(found.out.ends_with("\n7 problems\n"));
    }

    TEST_CASE("check: half of the pressed tactels at 255 are too many, fewer are counted") {
        const workshop shop;
        std::vector<std::uint8_t> pixels(rows * columns);
        std::fill_n(pixels.begin(), 21, std::uint8_t{100});
        std::fill_n(pixels.begin(), 10, std::uint8_t{255});
        write_png(shop.data() / "left/image1.png", rows, columns, pixels);
        outcome found = check(shop, shop.data());
        CHECK(found.status == 0);
        CHECK(shows(found, "\nleft 12 7x13 0 1\n"));
        pixels[20] = 0;
        write_png(shop.data() / "left/image1.png", rows, columns, pixels);
        found = check(shop, shop.data());
        CHECK(found.status == 1);
        CHECK(shows(found, "left/image1.png: expected pressures that the sensor can tell, found 10 of 20 "));
    }

    TEST_CASE("check: copies within a class and files that are no images are reported, and no problem") {
        const workshop shop;
        fs::copy_file(shop.data() / "left/image0.png", shop.data() / "left/image12.png");
        tactnet::write_file(shop.data() / "right/notes.txt", std::string("notes"));
        tactnet::write_file(shop.data() / "right/.hidden.png", std::string("hidden"));
        tactnet::write_file(shop.data() / "beside.png", std::string("beside"));
        const outcome found = check(shop, shop.data());
        CHECK_MESSAGE(found.status == 0, found.out);
        CHECK(shows(found, "\nleft/image12.png is a copy of left/image0.png: "));
        CHECK(shows(found, "\n2 files are no images of a class and are passed over, such as beside.png\n"));
        CHECK(found.out.ends_with("\nnothing is wrong\n"));
    }

    TEST_CASE("check: names are shown as text, and what is no folder of classes is refused") {
        const workshop shop;
        tactnet::write_file(shop.data() / "right/\nim\x1B[31mage.png", std::string("no image"));
        const outcome found = check(shop, shop.data());
        CHECK(found.status == 1);
        CHECK(shows(found, "right/\\x0aim\\x1b[31mage.png: expected "));
        CHECK(!shows(found, "\x1B"));
        fs::rename(shop.data() / "left", shop.data() / "le\x1B[31mft");
        shop.refuses("check --data DATA",
                     "subfolder 'le\\x1b[31mft': expected a name without control characters, found some");
        shop.refuses("check --data nowhere",
                     "nowhere: expected a folder with one subfolder a class, found nothing of that name");
        shop.refuses("check", "--data is required");
    }

    TEST_CASE("check: the paper's images are known, by their pixels" * doctest::test_suite("data")) {
        const auto data = find_data("tactile_images");
        if (!data)
            return;
        const workshop shop;
        const outcome found = check(shop, *data);
        CHECK_MESSAGE(found.status == 0, found.out);
        CHECK(shows(found, "\nall 1 100 28x50 5 462\n"));
        CHECK(shows(found, "These are the paper's 1 100 images of 22 classes, 28x50, of which 5 are copies "
                           "(github.com/"));
        for (const char* copy : {"bottle/bottle16.jpg is a copy of bottle/bottle12.jpg",
                                 "bottle/bottle19.jpg is a copy of bottle/bottle15.jpg",
                                 "caliper/caliper50.jpg is a copy of caliper/caliper48.jpg"})
            CHECK_MESSAGE(shows(found, copy), copy);

        // By the pixels of a class's images, whatever they and their class are called.
        fs::copy(*data, shop / "copy", fs::copy_options::recursive);
        fs::rename(shop / "copy/bottle", shop / "copy/a flask");
        fs::rename(shop / "copy/caliper/caliper1.jpg", shop / "copy/caliper/last.jpg");
        CHECK(shows(check(shop, shop / "copy"), "\nThese are the paper's"));
        // In 16 bits, up to 65535, they are the same to the last pixel.
        for (const auto& entry : fs::recursive_directory_iterator(shop / "copy"))
            if (entry.path().extension() == ".jpg") {
                const fs::path deep = shop / "deep" / entry.path().lexically_relative(shop / "copy");
                fs::create_directories(deep.parent_path());
                write_deeper(entry.path(), deep, 257);
            }
        tactnet::write_file(shop / "mat.json",
                            std::string(R"({"rows": 28, "columns": 50, "full_scale": 65535})"));
        CHECK(shows(shop.run("check --data deep --sensor mat.json"), "\nThese are the paper's"));
        fs::rename(shop / "copy/caliper/last.jpg", shop / "copy/a flask/last.jpg");
        CHECK(shows(check(shop, shop / "copy"), "\nThese are not the paper's"));
    }
}
