#pragma once

#include "methods/method.hpp"
#include "methods/networks/any_model.hpp"

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/training/loop.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// A training by the library's loop; what it makes of the best network is left to others.
class looped_training : public network_training {
public:
    bool finished() const override { return loop_.finished(); }
    void advance() override { loop_.run_epoch(); }
    const std::vector<tactnet::epoch_report>& history() const override { return loop_.history(); }
    std::size_t images_per_epoch() const override { return loop_.samples_per_epoch(); }
    const tactnet::data_split& split() const override { return loop_.split(); }
    void save_checkpoint(const std::filesystem::path& path, const tactnet::file_metadata& settings) override {
        tactnet::save_checkpoint(path, loop_, settings);
    }
    tactnet::checksum_state load_checkpoint(const std::filesystem::path& path,
                                            const tactnet::file_metadata& settings) override {
        return tactnet::load_checkpoint(path, loop_, settings);
    }

protected:
    looped_training(std::unique_ptr<tactnet::trainable> network, const tactnet::recipe& recipe,
                    const tactnet::labelled_samples& samples, tactnet::data_split split, std::uint64_t seed,
                    tactnet::thread_pool& threads)
        : loop_(std::move(network), recipe, samples, std::move(split), seed, threads) {}

    any_model best_model(const std::vector<std::string>& classes) const {
        return {loop_.best().copy(), {loop_.mean().begin(), loop_.mean().end()}, loop_.scale(), classes};
    }
    tactnet::training_loop& loop() { return loop_; }

private:
    tactnet::training_loop loop_;
};
