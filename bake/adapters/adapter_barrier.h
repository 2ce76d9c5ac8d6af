/* adapter_barrier.h - the exception barrier that every adapter's C function stands behind.
 *
 * C++ only; included by the adapters' .cpp files, never by their C headers.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_ADAPTER_BARRIER_H
#define PARIAN_BAKE_ADAPTER_BARRIER_H

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "core/memory.h"

namespace parian
{

/* An error of our own on its way to the barrier: the result and the line to be logged. */
class failure : public std::runtime_error
{
  public:
    failure(parian_result result, const std::string &line)
        : std::runtime_error(line), result_(result)
    {
    }
    parian_result result() const
    {
        return result_;
    }

  private:
    parian_result result_;
};

/* Run body, a callable that returns a parian_result, and let no exception out of it. A body that
 * returns an error has logged its line; whatever is thrown is logged here, in one line that begins
 * with `what` (the library and the file or step): std::bad_alloc, std::length_error  PARIAN_E_NOMEM
 *   parian::failure                    its own result
 *   anything else                      `otherwise` (PARIAN_E_FORMAT for readers, else
 * PARIAN_E_COMPUTE), with the library's own message */
template <class Body>
parian_result guard(const parian_env *env, const char *what, parian_result otherwise,
                    Body &&body) noexcept
{
    try {
        return body();
    } catch (const failure &error) {
        return parian_fail(env, error.result(), "%s: %s", what, error.what());
    } catch (const std::bad_alloc &) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: out of memory", what);
    } catch (const std::length_error &) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: more elements than memory can hold", what);
    } catch (const std::exception &error) {
        std::string line(error.what());
        for (char &letter : line) {
            letter = letter >= ' ' && letter <= '~' ? letter : '?'; /* it may quote broken input */
        }
        return parian_fail(env, otherwise, "%s: %s", what, line.c_str());
    } catch (...) {
        return parian_fail(env, otherwise, "%s: an unknown error", what);
    }
}

/* The arrays of a C struct that is being filled: allocate through env or throw. */
template <class Element> Element *new_array(const parian_env *env, size_t count)
{
    void *memory = parian_alloc(env, count, sizeof(Element));
    if (!memory) {
        throw std::bad_alloc();
    }
    return static_cast<Element *>(memory);
}

} // namespace parian

#endif
