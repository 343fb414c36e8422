"""Event streams, frames, series and metrics, of ended runs and of runs that compute.

usage: data_test.py QUICKSAND SMALL_CASE [unittest options]
"""

import csv
import io
import json
import os
import struct
import threading
import time

import h5py
import numpy

from server_test import ServerTest, endless_case, main, small_case


def read_frame(body):
    """Header and arrays of a frame's bytes."""
    (length,) = struct.unpack_from("<I", body)
    header = json.loads(body[4:4 + length])
    arrays = {}
    for array in header["arrays"]:
        begin = 4 + length + array["offset"]
        assert begin % 8 == 0
        values = numpy.frombuffer(body[begin:begin + array["bytes"]], dtype=array["type"])
        arrays[array["name"]] = values.reshape(-1, array["components"]).squeeze(1) if array["components"] == 1 \
            else values.reshape(-1, array["components"])
    return header, arrays


class DataTest(ServerTest):
    """Against h5py on the result file."""

    options = ("--workers", "1", "--set", "max_data_bytes=8k")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_id = cls().finished(small_case())
        cls.file = h5py.File(os.path.join(cls.state, "runs", cls.run_id, "result.vtkhdf"))

    @classmethod
    def tearDownClass(cls):
        cls.file.close()
        super().tearDownClass()

    def runTest(self):
        """Only so that setUpClass can use the helpers."""

    def frame(self, k, query=""):
        answer = self.server.get(f"/v1/runs/{self.run_id}/frames/{k}{query}")
        self.assertEqual(answer.status, 200, answer.body)
        return read_frame(answer.body)

    def test_frames_are_those_of_the_file(self):
        for k, (_, frame) in enumerate(self.file["frames"].items()):
            for fields in ("position,phase,body", "velocity,pore_pressure", "effective_stress"):
                header, arrays = self.frame(k, f"?fields={fields}&stride=2")
                self.assertEqual((header["index"], header["time"]), (k, frame.attrs["time"]))
                self.assertEqual((header["stage"], header["points"]), ("rest", len(frame["phase"])))
                self.assertEqual(list(arrays), fields.split(","))
                for name, values in arrays.items():
                    numpy.testing.assert_array_equal(values, frame[name][()][::2].astype(values.dtype), name)

    def test_what_a_frame_has_is_told(self):
        answer = self.server.get(f"/v1/runs/{self.run_id}/frames/0?fields=colour")
        self.assert_problem(answer, 400)
        self.assertIn("pore_pressure", answer.json()["detail"])
        answer = self.server.get(f"/v1/runs/{self.run_id}/frames/0")
        self.assert_problem(answer, 400)
        self.assertIn("max_data_bytes", answer.json()["detail"])
        frames = len(self.file["frames"])
        for k in (frames, 10**30, "-1", "x"):
            self.assert_problem(self.server.get(f"/v1/runs/{self.run_id}/frames/{k}"), 404)
        for query in ("stride=0", "stride=x", "fields=", "fields=position&fields=phase"):
            self.assert_problem(self.server.get(f"/v1/runs/{self.run_id}/frames/0?{query}"), 400)

    def test_series_are_those_of_the_file(self):
        listed = self.server.get(f"/v1/runs/{self.run_id}/series").json()["series"]
        self.assertEqual([series["name"] for series in listed], list(self.file["series"]))
        for series in listed:
            stored = self.file["series"][series["name"]]
            answer = self.server.get(f"/v1/runs/{self.run_id}/series?name={series['name']}").json()["series"][0]
            self.assertEqual(answer["unit"], stored["value"].attrs["unit"].decode())
            numpy.testing.assert_array_equal(answer["time"], stored["time"][()])
            numpy.testing.assert_array_equal(answer["value"], stored["value"][()].ravel())

    def test_series_as_csv(self):
        answer = self.server.get(f"/v1/runs/{self.run_id}/series?name=probe.below,ledger.momentum&format=csv")
        self.assertEqual(answer.headers["Content-Type"], "text/csv; charset=utf-8")
        head, *rows = csv.reader(io.StringIO(answer.body.decode()))
        self.assertEqual(head[0], "time [s]")
        self.assertTrue(head[1].startswith("probe.below"))
        values = numpy.array(rows, dtype=float)
        self.assertEqual(values.shape[1], len(head))
        numpy.testing.assert_allclose(values[:, 1], self.file["series/probe.below/value"][()], rtol=1e-11)

    def test_metrics_count(self):
        text = self.server.get("/metrics").body.decode()
        self.assertIn('quicksand_runs{status="succeeded"} 1', text)
        for name in ("steps_total", "disk_free_bytes", "resident_bytes", "http_seconds_bucket", "http_answers_total"):
            self.assertIn("quicksand_" + name, text)
        steps = float(text.split("\nquicksand_steps_total ")[1].split()[0])
        self.assertEqual(steps, self.server.get(f"/v1/runs/{self.run_id}").json()["progress"]["step"])


class LiveDataTest(ServerTest):
    """While a run computes."""

    options = ("--workers", "1", "--set", "max_streams=2")

    def events(self, response):
        """Yields (id, run) as they come."""
        fields = {}
        for line in response:
            line = line.decode().rstrip("\n")
            if line.startswith(":"):
                continue
            if line:
                name, _, value = line.partition(": ")
                fields[name] = value
            elif fields:
                yield int(fields["id"]), json.loads(fields["data"])
                fields = {}

    def test_events_until_the_end_and_again_from_the_middle(self):
        run_id = self.submit(endless_case())
        path = f"/v1/runs/{run_id}/events"
        with self.server.open(path, {"Accept-Encoding": "gzip"}) as response:
            self.assertEqual(response.headers["Content-Type"], "text/event-stream")
            self.assertIsNone(response.headers["Content-Encoding"])
            timer = threading.Timer(1.5, self.cancel, [run_id])
            timer.start()
            seen = list(self.events(response))
            timer.join()
        ids = [number for number, _ in seen]
        self.assertEqual(ids, sorted(set(ids)))
        states = [run["status"] for _, run in seen]
        self.assertEqual(states[-1], "canceled")
        self.assertIn("running", states)
        with self.server.open(path, {"Last-Event-ID": str(ids[-2])}) as response:
            self.assertEqual([number for number, _ in self.events(response)], ids[-1:])
        self.assertEqual(self.server.get(path, Last_Event_ID=str(ids[-1])).status, 204)

    def test_streams_are_counted_and_given_back(self):
        run_id = self.submit(endless_case())
        path = f"/v1/runs/{run_id}/events"
        with self.server.open(path) as one, self.server.open(path) as two:
            for stream in (one, two):
                next(self.events(stream))
            full = self.server.get(path)
            self.assert_problem(full, 503)
            self.assertIn("max_streams", full.json()["detail"])
            self.assertTrue(int(full.headers["Retry-After"]) > 0)
        deadline = time.monotonic() + 20  # seen when the next event cannot be sent
        while "quicksand_streams 0" not in self.server.get("/metrics").body.decode():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.1)
        self.cancel(run_id)

    def test_frames_and_series_while_it_computes(self):
        run_id = self.submit(endless_case())
        self.assertIn(self.server.get(f"/v1/runs/{run_id}/series").status, (200, 404))
        last = -1
        deadline = time.monotonic() + 30
        while last < 3:  # as the frames come
            self.assertLess(time.monotonic(), deadline)
            answer = self.server.get(f"/v1/runs/{run_id}/frames/{last + 1}?fields=position")
            if answer.status == 404:
                time.sleep(0.05)
                continue
            self.assertEqual(answer.status, 200, answer.body)
            last += 1
            self.assertEqual(read_frame(answer.body)[0]["index"], last)
        series = self.server.get(f"/v1/runs/{run_id}/series?name=probe.below").json()["series"][0]
        self.assertEqual(len(series["time"]), len(series["value"]))
        self.assertGreater(len(series["time"]), 0)
        self.cancel(run_id)
        with h5py.File(os.path.join(self.state, "runs", run_id, "result.vtkhdf")) as file:
            self.assertGreater(len(file["frames"]), last)


if __name__ == "__main__":
    main()
