#pragma once
#include <string>

namespace quicksand {

/// The description of the HTTP interface, OpenAPI 3.1 in YAML, as shipped in api/openapi.yaml (compiled in).
const std::string& openapi_document();

}  // namespace quicksand
