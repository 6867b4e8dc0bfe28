#pragma once

#include "core/Result.h"

#include <pugixml.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// The text of an .earth file, for line numbers, which pugixml does not count.
class EarthXml
{
public:
    /// Both are used and outlive it. source: what messages call the text.
    EarthXml(const std::string& text, const std::string& source) : _text(text), _source(source) {}

    const std::string& source() const { return _source; }
    int lineAt(std::size_t offset) const;
    int lineOf(const pugi::xml_node& node) const;
    /// Line of an attribute, which may stand below its element's name.
    int lineOf(const pugi::xml_node& node, const std::string& attribute) const;
    /// With source and line before the sentence.
    Error error(int line, const std::string& sentence) const;

private:
    const std::string& _text;
    const std::string& _source;
};

/// osgEarth takes names of elements and keys in any case.
std::string lowerCase(std::string text);

/// Without blanks at its ends.
std::string trimmed(const std::string& text);

/// The value of a key (lower case), which osgEarth lets stand as an attribute or as a child; the
/// first that is not empty.
std::string valueOf(const pugi::xml_node& element, const std::string& key);

/// Names of all keys of an element, as they are written.
std::vector<std::string> keysOf(const pugi::xml_node& element);

/// A path that may have been written on Windows, with the slashes that all systems know.
std::string withSlashes(std::string path);

/// Appends to a list in a sentence.
void append(std::string& list, const std::string& item);

} // namespace osgTerrainLight
