"""The OpenAPI document and the live server say the same, both ways.

usage: openapi_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import contextlib
import os
import re
import sqlite3
import time

import jsonschema
import yaml

from server_test import ServerTest, endless_case, main, make_key, small_case

METHODS = ("get", "post", "delete", "head")


def strict(schema):
    """The same, where an object of named properties has no others."""
    if isinstance(schema, list):
        return [strict(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    schema = {key: strict(value) for key, value in schema.items()}
    if isinstance(schema.get("properties"), dict) and schema.get("type") == "object":
        schema.setdefault("additionalProperties", False)
    return schema


class DocumentTest(ServerTest):
    """Holds answers against the document."""

    options = ("--workers", "1", "--set", "max_streams=1", "--set", "max_queued=1")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.document = strict(yaml.safe_load(cls.server.get("/v1/openapi.yaml").body))
        cls.seen = set()  # (method, path, status) of every answer that was compared

    def resolved(self, node):
        while "$ref" in node:
            target = self.document
            for step in node["$ref"].removeprefix("#/").split("/"):
                target = target[step]
            node = target
        return node

    def operations(self):
        for path, item in self.document["paths"].items():
            for method in METHODS:
                if method in item:
                    yield path, method, item[method]

    def parameters(self, path, operation, place):
        both = self.document["paths"][path].get("parameters", []) + operation.get("parameters", [])
        return [p for p in map(self.resolved, both) if p["in"] == place]

    def ask_head(self, url, headers):
        """Every GET can be asked as HEAD: the same status, no body."""
        head = self.server.call("HEAD", url, headers=headers)
        self.assertEqual((head.status, head.body), (200, b""), url)

    def ask(self, method, path, status, body=None, query="", headers=None, **values):
        """Asks for a path of the document and holds the answer against it."""
        url = re.sub(r"{(\w+)}", lambda name: str(values[name[1]]), path) + query
        answer = self.server.call(method.upper(), url, body, headers)
        where = f"{method} {url}: {answer.status}"
        self.assertEqual(answer.status, status, f"{where} {answer.body[:300]}")
        responses = self.document["paths"][path][method]["responses"]
        self.assertIn(str(status), responses, where)
        self.compare(self.resolved(responses[str(status)]), answer, where, method == "head")
        self.seen.add((method, path, str(status)))
        if (method, status) == ("get", 200):
            self.ask_head(url, headers or {})
        return answer

    def compare(self, response, answer, where, head):
        for name, header in response.get("headers", {}).items():
            if header.get("required"):
                self.assertIn(name, answer.headers, where)
        content = response.get("content", {})
        if not content:
            self.assertEqual(answer.body, b"", where)
            return
        kind = answer.headers["Content-Type"].split(";")[0]
        self.assertIn(kind, content, where)
        if kind.endswith("json") and not head and answer.status != 206:
            schema = {**content[kind].get("schema", {}), "components": self.document["components"]}
            jsonschema.Draft202012Validator(schema).validate(answer.json())


class DocumentedIsServedTest(DocumentTest):
    """Every operation and every status that the document names."""

    def test_everything_documented_is_served_as_documented(self):
        case = small_case()
        ladder = self.ask("post", "/v1/runs", 201, case, "?kind=tradeoff&budget=1").json()["id"]
        self.server.wait_for(ladder, "succeeded")
        self.ask("get", "/v1/runs/{id}", 200, id=ladder)
        run = self.ask("post", "/v1/runs", 201, case, "?label=x", {"Idempotency-Key": "one"}).json()["id"]
        self.server.wait_for(run, "succeeded")
        self.ask_what_goes_well(case, run)
        self.ask_what_is_wrong(case, run)
        self.ask_too_much(run)
        self.ask_a_server_without_room(run)
        self.ask_on_a_full_disk()
        self.ask_for_another_role(run)
        self.ask_for_what_is_removed(run)
        documented = {(method, path, status) for path, method, operation in self.operations()
                      for status in operation["responses"] if status != "default"}
        self.assertEqual(documented - self.seen, set())

    def ask_what_goes_well(self, case, run):
        self.assertIsNone(self.ask("post", "/v1/validate", 200, case).json()["trial"])
        tried = self.ask("post", "/v1/validate", 200, case, "?trial=1").json()
        self.assertGreaterEqual(tried["trial"]["cell_size"], tried["cell_size"])
        self.ask("post", "/v1/validate", 400, case, "?trial=6")
        self.ask("get", "/v1/runs", 200, query="?status=succeeded&limit=1")
        tag = self.ask("get", "/v1/runs/{id}", 200, id=run).headers["ETag"]
        self.ask("get", "/v1/runs/{id}", 304, headers={"If-None-Match": tag}, id=run)
        self.ask("post", "/v1/runs/{id}/cancel", 200, id=run)
        for part in ("case", "log", "events", "series", "results"):
            self.ask("get", "/v1/runs/{id}/" + part, 200, id=run)
        self.ask("get", "/v1/runs/{id}/series", 200, query="?name=ledger.water_volume,probe.below", id=run)
        self.ask("get", "/v1/runs/{id}/series", 200, query="?name=probe.below&format=csv", id=run)
        self.ask("get", "/v1/runs/{id}/events", 204, headers={"Last-Event-ID": "999999"}, id=run)
        self.ask("get", "/v1/runs/{id}/frames/{k}", 200, query="?fields=position&stride=2", id=run, k=0)
        file = "/v1/runs/{id}/results/{file}"
        for name in ("result.vtkhdf", "result.xdmf", "run.json"):
            tag = self.ask("get", file, 200, id=run, file=name).headers["ETag"]
        for method in ("get", "head"):
            self.ask(method, file, 200, id=run, file="run.json")
            self.ask(method, file, 206, headers={"Range": "bytes=0-9"}, id=run, file="run.json")
            self.ask(method, file, 304, headers={"If-None-Match": tag}, id=run, file="run.json")
            self.ask(method, file, 416, headers={"Range": "bytes=99999999-"}, id=run, file="run.json")
            self.ask(method, file, 404, id=run, file="none")
        name = self.ask("get", "/v1/cases", 200).json()["cases"][0]["name"]
        self.ask("get", "/v1/cases/{name}", 200, name=name)
        for path in ("/v1/schemas/case", "/v1/openapi.yaml", "/v1/service-info", "/healthz", "/readyz", "/metrics"):
            self.ask("get", path, 200)

    def ask_what_is_wrong(self, case, run):
        self.ask("post", "/v1/runs", 400, case, headers={"Idempotency-Key": "x" * 256})
        self.ask("post", "/v1/runs", 422, {**case, "name": "other"}, headers={"Idempotency-Key": "one"})
        for path in ("/v1/runs", "/v1/validate"):
            self.ask("post", path, 422, {**case, "colour": "blue"})
            self.ask("post", path, 411, headers={"Transfer-Encoding": "chunked"})
            self.ask("post", path, 415, "{}", headers={"Content-Type": "text/plain"})
            self.ask("post", path, 413, headers={"Content-Length": str(5 << 20)})
        self.ask("get", "/v1/runs", 400, query="?limit=0")
        self.ask("get", "/v1/runs/{id}/events", 400, headers={"Last-Event-ID": "x"}, id=run)
        self.ask("get", "/v1/runs/{id}/series", 400, query="?name=none", id=run)
        self.ask("get", "/v1/runs/{id}/frames/{k}", 400, query="?fields=none", id=run, k=0)
        self.ask("get", "/v1/cases/{name}", 404, name="none")
        for path, method, operation in self.operations():
            if "404" in operation["responses"] and "{id}" in path:
                self.ask(method, path, 404, id="0123456789abcdef", file="run.json", k=0)

    def ask_too_much(self, run):
        running = self.ask("post", "/v1/runs", 201, endless_case()).json()["id"]
        self.server.wait_for(running, "running")
        queued = self.ask("post", "/v1/runs", 201, small_case()).json()["id"]
        self.ask("post", "/v1/runs", 503, small_case())
        self.ask("delete", "/v1/runs/{id}", 409, id=running)
        with self.server.open(f"/v1/runs/{running}/events"):
            self.ask("get", "/v1/runs/{id}/events", 503, id=run)
        for one in (queued, running):
            self.ask("post", "/v1/runs/{id}/cancel", 200, id=one)
            self.server.wait_for(one, "canceled")
        self.ask("delete", "/v1/runs/{id}", 204, id=queued)

    def ask_on_a_full_disk(self):
        self.server.stop()
        self.server.options = ["--workers", "1", "--set", "disk_reserve=8000T", "--set", "max_runs_per_key=1"]
        self.server.start()
        answer = self.ask("post", "/v1/runs", 507, small_case())
        self.assertIn("8000T (disk_reserve)", answer.json()["detail"])
        self.ask("get", "/readyz", 503)

    def ask_for_what_is_removed(self, run):
        self.server.stop()
        with contextlib.closing(sqlite3.connect(os.path.join(self.state, "quicksand.db"))) as store, store:
            store.execute("UPDATE runs SET finished = 0 WHERE id = ?", [run])
        self.server.options = ["--set", "keep_days=1", "--set", "max_runs_per_key=1"]
        self.server.start()
        headers = {"X-API-Key": make_key(self.state, "root", "admin")}
        deadline = time.monotonic() + 10
        while not self.ask("get", "/v1/runs/{id}", 200, headers=headers, id=run).json()["results_removed"]:
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        for part in ("results", "series"):
            self.ask("get", "/v1/runs/{id}/" + part, 410, headers=headers, id=run)
        self.ask("get", "/v1/runs/{id}/frames/{k}", 410, headers=headers, id=run, k=0)
        for method in ("get", "head"):
            self.ask(method, "/v1/runs/{id}/results/{file}", 410, headers=headers, id=run, file="run.json")
        self.assertEqual(os.listdir(os.path.join(self.state, "runs", run)), ["run.log"])
        self.ask("post", "/v1/runs", 201, endless_case(), headers=headers)
        self.ask("post", "/v1/runs", 429, small_case(), headers=headers)

    def ask_for_another_role(self, run):
        """Every operation wants a key but those that say otherwise; 403 stands where a role is too small."""
        keys = {role: make_key(self.state, role, role) for role in ("read", "submit")}
        for path, method, operation in self.operations():
            values = {"id": run, "file": "run.json", "k": 0, "name": "heave"}
            if operation.get("security") == []:
                self.assertNotIn(self.server.call(method.upper(), path).status, (401, 403), path)
                continue
            body = {} if method == "post" else None
            self.ask(method, path, 401, body, **values)
            answers = [self.server.call(method.upper(), re.sub(r"{(\w+)}", lambda n: str(values[n[1]]), path), body,
                                        {"X-API-Key": key}) for key in keys.values()]
            self.assertEqual(403 in (answer.status for answer in answers), "403" in operation["responses"], path)
            if "403" in operation["responses"]:
                role = list(keys.values())[answers[1].status == 403]
                self.ask(method, path, 403, body, headers={"X-API-Key": role}, **values)

    def ask_a_server_without_room(self, run):
        self.server.stop()
        self.server.options = ["--set", "max_readers=0", "--set", "max_downloads=0", "--set", "max_trials=0"]
        self.server.start()
        self.ask("get", "/v1/runs/{id}/frames/{k}", 503, id=run, k=0)
        self.ask("get", "/v1/runs/{id}/series", 503, id=run)
        self.ask("post", "/v1/validate", 503, small_case(), "?trial=1")
        self.ask("get", "/v1/runs/{id}/log", 503, id=run)
        self.ask("get", "/v1/runs/{id}/results/{file}", 503, id=run, file="run.json")


class ServedIsDocumentedTest(DocumentTest):
    """Methods and query parameters; that no path is missing is tests/server/routes_test.cpp."""

    def test_everything_served_is_documented(self):
        for path, item in self.document["paths"].items():
            url = re.sub(r"{\w+}", "x", path)
            allowed = self.server.call("PATCH", url)
            self.assert_problem(allowed, 405)
            methods = {method.upper() for method in METHODS if method in item}
            self.assertEqual(set(allowed.headers["Allow"].split(", ")), methods | ({"HEAD"} if "GET" in methods else set()))
        for path, method, operation in self.operations():
            if method == "head":
                continue
            url = re.sub(r"{\w+}", "x", path) + "?undocumented=1"
            answer = self.server.call(method.upper(), url, small_case() if method == "post" else None)
            self.assert_problem(answer, 400)
            known = answer.json()["detail"].split("known here: ")[1]
            names = {p["name"] for p in self.parameters(path, operation, "query")}
            self.assertEqual(set() if known == "none" else set(known.split(", ")), names, url)


if __name__ == "__main__":
    main()
