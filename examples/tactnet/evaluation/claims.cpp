#include "evaluation/claims.hpp"

#include "data/fingerprint.hpp"

#include <cerrno>
#include <cstdint>
#include <fcntl.h>
#include <unistd.h>

namespace {

/// A lock on one byte of a file that has none: the settings say which.
struct flock byte_of(const tactnet::file_metadata& settings, short type) {
    fingerprint print;
    for (const auto& [key, value] : settings) {
        print.add(key);
        print.add(value);
    }
    struct flock lock {};
    lock.l_type = type;
    lock.l_whence = SEEK_SET;
    lock.l_start = static_cast<off_t>(print.value() >> 2);
    lock.l_len = 1;
    return lock;
}

} // namespace

training_claims::training_claims(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {}

training_claims::~training_claims() {
    if (descriptor_ >= 0)
        ::close(descriptor_);
}

bool training_claims::take(const tactnet::file_metadata& settings) {
    struct flock lock = byte_of(settings, F_WRLCK);
    return descriptor_ < 0 || ::fcntl(descriptor_, F_SETLK, &lock) == 0 ||
           (errno != EAGAIN && errno != EACCES);
}

void training_claims::release(const tactnet::file_metadata& settings) {
    struct flock lock = byte_of(settings, F_UNLCK);
    if (descriptor_ >= 0)
        static_cast<void>(::fcntl(descriptor_, F_SETLK, &lock));
}
