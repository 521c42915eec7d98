// What a frame must not do, each once: check.cmake has to find them.

#include <mutex>
#include <vector>

struct layer {
    virtual void run(float* map) const = 0;

protected:
    ~layer() = default;
};

void frame_by_layers(const layer* const* layers, int count, float* map) {
    for (int i = 0; i < count; ++i)
        layers[i]->run(map);
}
std::vector<float> frame_on_the_heap(std::size_t size) {
    return std::vector<float>(size);
}
void frame_with_a_lock(std::mutex& lock, float* map) {
    const std::lock_guard<std::mutex> guard(lock);
    *map = 0;
}
