// Operators new and delete over functions that can fail (allocator.h), because the C++ library's
// operators are linked without them.
#include <cstdlib>
#include <new>

void *operator new(std::size_t size)
{
    void *bytes = std::malloc(size ? size : 1);
    if (!bytes) throw std::bad_alloc();
    return bytes;
}

void operator delete(void *bytes) noexcept
{
    std::free(bytes);
}

void operator delete(void *bytes, std::size_t) noexcept
{
    std::free(bytes);
}
