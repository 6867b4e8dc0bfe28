// What fuzzers share: damage, the loop, its options.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

using Random = std::mt19937_64;

inline std::string bytesOf(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// One to eight changes: of bits and bytes, of 32-bit integers, of blocks, of the length.
inline std::string mutated(std::string bytes, const std::string& other, Random& random)
{
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
    constexpr std::uint32_t odd[] = {0u,          1u,          2u,      0xffffffffu,
                                     0x7fffffffu, 0x80000000u, 0xffffu, 0x7fc00000u,
                                     0x7f800000u, 16u,         100000u};
    for (std::size_t change = 1 + below(8); change > 0; --change)
    {
        // Half of them in the header.
        const std::size_t reach =
            random() % 2 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size();
        const std::size_t place = below(reach);
        const std::size_t length = std::min(1 + below(16), bytes.size() - place);
        if (bytes.empty())
            return bytes;
        switch (random() % 8)
        {
        case 0:
            bytes[place] = static_cast<char>(bytes[place] ^ (1 << random() % 8));
            break;
        case 1:
            bytes[place] = static_cast<char>(random());
            break;
        case 2:
        case 3:
            if (place + 4 <= bytes.size())
                std::memcpy(&bytes[place], &odd[below(std::size(odd))], 4);
            break;
        case 4:
            bytes.erase(place, length);
            break;
        case 5:
            bytes.insert(place, bytes.substr(below(bytes.size()), length));
            break;
        case 6:
            if (!other.empty())
                bytes.replace(place, length, other.substr(below(other.size()), length));
            break;
        default:
            if (random() % 4 == 0)
                bytes.resize(place);
        }
    }
    return bytes;
}

inline void require(bool holds, const char* what)
{
    if (holds)
        return;
    std::cerr << "fuzz: " << what << '\n';
    std::abort();
}

/// Each run has a folder of its own, so that two runs at a time do not meet. It stays after a
/// crash, with the file at hand.
struct FuzzOptions
{
    FuzzOptions(int count, char** arguments, const char* program) : name(program)
    {
        for (int i = 1; i < count; ++i)
        {
            const std::string option = arguments[i];
            const char* value = i + 1 < count ? arguments[i + 1] : nullptr;
            if (option == "--keep")
            {
                keep = true;
                continue;
            }
            if (option == "--seed" && value)
                seed = std::strtoull(value, nullptr, 10);
            else if (option == "--runs" && value)
                runs = std::strtoull(value, nullptr, 10);
            else if (option == "--seconds" && value)
                seconds = std::atof(value);
            else
            {
                std::cerr << option << ": needed --seed N, --runs N, --seconds N or --keep\n";
                std::exit(2);
            }
            ++i;
        }
        folder = std::filesystem::temp_directory_path() / (name + '-' + std::to_string(getpid()));
        std::filesystem::create_directories(folder);
        std::cout << name << ": seed " << seed << ", files in " << folder.string() << std::endl;
    }
    std::string file(const std::string& of) const { return (folder / of).string(); }

    std::string name;
    std::uint64_t seed = 1, runs = 0;
    double seconds = 10.0;
    bool keep = false;
    std::filesystem::path folder;
};

/// Tries whole files, all of which must pass, then mutants of them and of mutants that passed.
template <class Try>
int fuzz(const FuzzOptions& options, std::vector<std::string> files, const Try& tries)
{
    const std::size_t first = files.size();
    for (const std::string& file : files)
        require(tries(file), ("a whole file is refused: " + file.substr(0, 100)).c_str());
    Random random(options.seed);
    std::uint64_t run = 0, passed = 0;
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&]
    { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    for (; options.runs > 0 ? run < options.runs : elapsed() < options.seconds; ++run)
    {
        const std::string mutant =
            mutated(files[random() % files.size()], files[random() % files.size()], random);
        if (!tries(mutant))
            continue;
        ++passed;
        // What was damaged and passed is damaged further.
        if (mutant.size() < 8192)
        {
            if (files.size() < first + 200)
                files.push_back(mutant);
            else
                files[first + random() % 200] = mutant;
        }
    }
    std::cout << options.name << ": seed " << options.seed << ", " << run << " files, " << passed
              << " passed, " << elapsed() << " s, clean\n";
    if (!options.keep)
        std::filesystem::remove_all(options.folder);
    return 0;
}
