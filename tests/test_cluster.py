"""A sweep on a cluster: two workers, one of them killed on the way."""

import os
import signal

import gripper as gr
from gripper.sweep.rows import read
from gripper_plugins.objects.circle import Circle
from tests.scenes import unit_finger

SCENE = gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=-0.2))
OVER = {"object.pose.y": [-0.2 + 1e-4 * i for i in range(60)]}


def test_of_a_cluster_that_loses_a_worker_on_the_way_nothing_is_lost_and_nothing_doubled(tmp_path):
    from distributed import Client, LocalCluster

    pids, killed = [], []

    def kill_one(done, total):
        if done >= 10 and not killed:
            killed.append(pids[0])
            os.kill(pids[0], signal.SIGKILL)

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        pids += client.run(os.getpid).values()
        with client.get_executor() as executor:
            table = gr.sweep(SCENE, OVER, tmp_path, executor=executor, progress=kill_one)
    assert len(set(pids)) == 2 and killed
    assert table.failed == ()
    assert [row.values[0] for row in table.rows] == OVER["object.pose.y"]
    lines = (tmp_path / "sweep.csv").read_text().splitlines(keepends=True)[1:]
    assert list(read(lines, list(OVER), None)) == list(table.rows)
