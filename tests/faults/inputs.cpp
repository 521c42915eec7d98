// Tables of images, archives of arrays and descriptions of sensors, damaged or saying what cannot be.

#include "groups.hpp"

#include <array>
#include <zlib.h>

namespace faults {
namespace {

using namespace std::string_literals;

std::string little(std::size_t value, std::size_t bytes) {
    std::string text;
    for (; bytes > 0; --bytes, value >>= 8U)
        text += static_cast<char>(value & 0xFFU);
    return text;
}

std::string npy(const std::string& shape, std::size_t cells, const std::string& type = "'|u1'") {
    const std::string head = "{'descr': " + type + ", 'fortran_order': False, 'shape': (" + shape + "), }\n";
    return "\x93NUMPY\1\0"s + little(head.size(), 2) + head + std::string(cells, '\7');
}

/// As numpy.savez writes it.
std::string archive_of(const std::vector<std::string>& arrays) {
    std::string all, directory;
    for (const std::string& array : arrays) {
        const auto sum =
            crc32(0, reinterpret_cast<const Bytef*>(array.data()), static_cast<uInt>(array.size()));
        const std::string entry = little(20, 2) + std::string(8, '\0') + little(sum, 4) +
                                  little(array.size(), 4) + little(array.size(), 4) + little(1, 2) +
                                  little(0, 2);
        directory += "PK\1\2\24\0"s + entry + std::string(10, '\0') + little(all.size(), 4) + "a";
        all += "PK\3\4"s + entry + "a" + array;
    }
    return all + directory + "PK\5\6\0\0\0\0"s + little(arrays.size(), 2) + little(arrays.size(), 2) +
           little(directory.size(), 4) + little(all.size(), 4) + "\0\0"s;
}

} // namespace

void spoil_tables(scene& s, std::size_t number) {
    const words command =
        s.made.tactnet({"train", "--data", (s.made / "data").string(), "--method", "svm-linear", "--rows",
                        "7", "--columns", "13", "--table", "t.csv", "--output", "out"});
    const auto write = [&](const std::vector<std::string>& lines) {
        write_bytes(s.folder / "t.csv", text_of(lines));
    };
    std::vector<std::string> lines{"path,label,split"};
    for (const std::string name : {"left", "\"middle, of all\"", "right"})
        for (std::size_t i = 0; i < 12; ++i)
            lines.push_back((name[0] == '"' ? name.substr(0, name.size() - 1) : "\"" + name) + "/image" +
                            std::to_string(i) + ".png\"," + name + (i < 9 ? ",training" : ",test"));
    const std::size_t row = 1 + s.below(lines.size() - 1);
    if (number % 4 == 0) { // a bit of the first line, whose meaning letters of another case keep
        static const std::string right = [&] {
            write(lines);
            s.expect(s.run(command, without_pictures).done(), "a table was refused");
            const std::string weights = bytes_of(s.folder / "out");
            fs::remove(s.folder / "out");
            return weights;
        }();
        lines[0] = damaged_by_bit(s, lines[0]);
        write(lines);
        const ending end = s.run(command, without_pictures);
        s.expect_message(end, "a table that begins with '" + lines[0] + "'");
        return s.expect(!end.done() || bytes_of(s.folder / "out") == right,
                        "a table that begins with '" + lines[0] + "': other weights without a word");
    }
    if (number % 4 == 1) {
        const std::array heads{"path,labels,split"s,      "label,split"s,
                               "path,label,label"s,       ",label,split"s,
                               "path,label,split,notes"s, ""s,
                               "path;label;split"s};
        lines[0] = s.one_of(heads);
    } else if (number % 4 == 2) { // another image's line
        lines[row] = lines[row % (lines.size() - 1) + 1];
    } else {
        const std::array ends{""s,          ","s,       ",exam"s,      ",test\x1b[2J"s,
                              ",test,"s,    ",\"test"s, ",te\"st"s,    ",test\0"s,
                              ",test\xFF"s, "\n"s,      ",\"test\"x"s, ",TEST"s};
        lines[row].replace(lines[row].rfind(','), std::string::npos, s.one_of(ends));
    }
    write(lines);
    expect_refusal(s, command, "t.csv", "a table with '" + lines[0] + "' and '" + lines[row] + "'");
}

void spoil_archives(scene& s, std::size_t number) {
    const words command{s.made.where().decode.string(), "--csv", "a.npz"};
    std::vector<std::string> arrays{npy("2, 3, 4", 24), npy("2,", 2), npy("3, 4", 12)};
    if (number % 2 == 0) { // every byte that matters has a sum or is repeated
        const std::string whole = archive_of(arrays);
        write_bytes(s.folder / "a.npz", whole);
        const std::string right = s.run(command).out;
        write_bytes(s.folder / "a.npz",
                    s.below(4) == 0 ? whole.substr(0, s.below(whole.size())) : damaged_by_bit(s, whole));
        const ending end = s.run(command);
        s.expect_message(end, "an archive");
        return s.expect(!end.error.empty() || end.out == right, "an archive: other frames without a word");
    }
    const std::array shapes{"1, 1, 3, 4"s, "1, 1, 1, 3, 4"s, "1, 4, 3"s, "99999999, 99999999"s, "1, 3, -4"s};
    const std::array types{"'<U3'"s, "'|O'"s, "'<c8'"s, "[('a', '<f4')]"s, "''"s, "'|u1"s};
    const std::string array =
        s.below(2) == 0 ? npy(s.one_of(shapes), 12) : npy("1, 3, 4", 96, s.one_of(types));
    arrays.insert(arrays.begin() + static_cast<std::ptrdiff_t>(s.below(arrays.size() + 1)), array);
    write_bytes(s.folder / "a.npz", archive_of(arrays));
    expect_refusal(s, command, "a.npz", "an archive with " + array.substr(10, array.find('\n') - 10));
}

void spoil_descriptions(scene& s, std::size_t number) {
    s.bring("plain.stream");
    const words command{s.made.where().decode.string(), "--csv", "--sensor", "d.json", "plain.stream"};
    const std::string whole = R"({"rows": 28, "columns": 50, "checksum": {"kind": "none"}, "offset": 0.5})";
    if (number % 4 == 0) { // may be another description
        write_bytes(s.folder / "d.json",
                    s.below(4) == 0 ? whole.substr(0, s.below(whole.size())) : damaged_by_bit(s, whole));
        return s.expect_message(s.run(command), "a description");
    }
    const std::array rows{"0"s,       "-1"s,   "1.5"s,  "1e9"s,  "99999999999999999999"s,
                          "\"28\""s,  "null"s, "true"s, "[28]"s, "{}"s,
                          "1048577"s, "028"s,  "0x1C"s, ""s};
    const std::array fields{R"("row": 3)"s,
                            R"("rows": 28)"s,
                            R"("cell": "uint9")"s,
                            R"("cell": 1)"s,
                            R"("rotation": 45)"s,
                            R"("offset": 1e999)"s,
                            R"("offset": nan)"s,
                            R"("marker": "A")"s,
                            R"("marker": "GG")"s,
                            R"("full_scale": 0)"s,
                            R"("full_scale": -1)"s,
                            R"("seconds_per_frame": -1)"s,
                            R"("header_bytes": -1)"s,
                            R"("broken": ["x"])"s,
                            R"("broken": 7)"s,
                            R"("header_bytes": 99999999999)"s,
                            R"("serpentine": 1)"s,
                            R"("checksum": [])"s,
                            R"("row_spacing": -1)"s,
                            R"("checksum": {"kind": "crc9"})"s,
                            R"("": 1)"s,
                            R"("\u001b[2J": 1)"s,
                            R"(1: 2)"s,
                            "\"broken\": " + std::string(1 + s.below(1'000'000), '['),
                            "\"" + std::string(1 + s.below(1'000'000), 'x') + "\": 1"};
    const std::string json = number % 4 == 1 ? "{\"rows\": " + s.one_of(rows) + ", \"columns\": 50}"
                                             : R"({"rows": 28, "columns": 50, )" + s.one_of(fields) + "}";
    write_bytes(s.folder / "d.json", json);
    expect_refusal(s, command, "d.json", json.substr(0, 100));
}

} // namespace faults
