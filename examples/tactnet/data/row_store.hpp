#pragma once

// Rows of numbers in a file that grows while they are found. Each carries a checksum, so that a program that
// is stopped, however that happens, continues with the rows that are missing.

#include <tactnet/io/model_file.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

class row_store {
public:
    /// What became of a file that was there.
    enum class found { nothing, these_rows, others };

    /// Opens or makes a file for `rows` rows of `size` numbers; `settings` are all that decides the numbers.
    /// `is_ours`: whether no other program can have made a file of that name. One program at a time may look
    /// and write: see claims. Throws tactnet::file_error.
    row_store(const std::filesystem::path& path, const tactnet::file_metadata& settings, std::size_t rows,
              std::size_t size, bool is_ours);
    row_store(const row_store&) = delete;
    row_store& operator=(const row_store&) = delete;
    ~row_store();

    /// What is in the file, which is begun anew unless it is of these settings. Throws tactnet::file_error;
    /// also for another program's file, unless it must be ours.
    found look();
    /// Those that are not there, or are damaged; known after `look`.
    const std::vector<std::size_t>& missing() const { return missing_; }
    /// How many of the missing ones are there and damaged.
    std::size_t damaged() const { return damaged_; }

    /// Throws tactnet::file_error.
    void write(std::size_t row, std::span<const float> values);
    /// Rows are on the disk when this returns.
    void flush();
    /// Any number of threads at a time. Throws tactnet::file_error for a row that is damaged.
    void read(std::size_t row, std::span<float> to) const;

private:
    /// Bytes of a row: its numbers, then their checksum.
    std::size_t row_bytes() const { return size_ * sizeof(float) + sizeof(std::uint64_t); }
    std::size_t place(std::size_t row) const { return head_.size() + row * row_bytes(); }
    std::uint64_t checksum(std::size_t row, std::span<const std::byte> values) const;
    /// Whether the row is there and right.
    bool read_row(std::size_t row, std::span<float> to) const;
    /// Returns how many bytes there are at the place.
    std::size_t get(std::span<std::byte> to, std::size_t place) const;
    void put(std::span<const std::byte> from, std::size_t place);
    [[noreturn]] void fail(const char* expected, int error) const;

    std::filesystem::path path_;
    std::string head_; ///< the first line, which names what the rows are of
    std::size_t rows_, size_;
    bool is_ours_;
    int descriptor_;
    std::vector<std::size_t> missing_;
    std::size_t damaged_ = 0;
};
