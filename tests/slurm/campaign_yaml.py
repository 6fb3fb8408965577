"""Check the manifests of a campaign on Kubernetes: names and types of fields, references, and what the containers run.

No cluster is involved. Fields are compared with the models of the official Python client. The containers' commands then run on this host,
one after another, with folders in the place of volumes and fewer cases; the joined files must be those of a single run.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import yaml
from kubernetes import client

ROOT = pathlib.Path(__file__).resolve().parents[2]
MANIFESTS = ROOT / 'tools/kubernetes/campaign.yaml'
SCRIPT = ROOT / 'tools/campaign.sbatch'
KINDS = {('v1', 'ConfigMap'): 'V1ConfigMap', ('batch/v1', 'Job'): 'V1Job'}
PLAIN = {'str': str, 'int': int, 'bool': bool, 'float': (int, float)}
FEWER = {'CAMPAIGN_RUNS': '28', 'CAMPAIGN_CASES': '3'}  # ten tasks, as in the manifest; the last has one case


def fields(value, kind, place):
    """Problems of a value that should be of a type, by the client's name of it."""
    if kind in PLAIN:
        return [] if isinstance(value, PLAIN[kind]) else [f'{place}: {value!r} is no {kind}']
    if found := re.fullmatch(r'[Ll]ist\[(.+)\]', kind):
        if not isinstance(value, list):
            return [f'{place}: no list']
        return [problem for i, item in enumerate(value) for problem in fields(item, found[1], f'{place}[{i}]')]
    if found := re.fullmatch(r'[Dd]ict[\[(](\w+), (\w+)[\])]', kind):
        return [problem for key, item in value.items() for problem in fields(key, found[1], place) + fields(item, found[2], f'{place}.{key}')]
    model = getattr(client, kind)
    if not isinstance(value, dict):
        return [f'{place}: no {kind}']
    names = {written: name for name, written in model.attribute_map.items()}
    problems = [f'{place}.{key}: {kind} has no such field' for key in value if key not in names]
    return problems + [problem for key, item in value.items() if key in names
                       for problem in fields(item, model.openapi_types[names[key]], f'{place}.{key}')]


def references(parts):
    """Problems of what one part says of another."""
    (parameters,) = [part for part in parts if part['kind'] == 'ConfigMap']
    jobs = [part for part in parts if part['kind'] == 'Job']
    known = set(re.findall(r'\$\{(CAMPAIGN_\w+)', SCRIPT.read_text()))
    problems = [f'{name}: campaign.sbatch does not read it' for name in parameters['data'] if name not in known]
    if problems:
        return problems
    runs, cases = (int(parameters['data'][name]) for name in ('CAMPAIGN_RUNS', 'CAMPAIGN_CASES'))
    shards = jobs[0]['spec']
    if shards.get('completionMode') != 'Indexed' or shards['completions'] != -(-runs // cases):
        problems.append(f'{runs} cases, {cases} per task, are no Indexed Job of {shards["completions"]} completions')
    for job in jobs:
        pod, name = job['spec']['template']['spec'], job['metadata']['name']
        if pod.get('restartPolicy') not in ('Never', 'OnFailure'):
            problems.append(f'{name}: a Job needs restartPolicy Never or OnFailure')
        volumes = {volume['name'] for volume in pod['volumes']}
        for container in pod['containers']:
            if container['envFrom'] != [{'configMapRef': {'name': parameters['metadata']['name']}}]:
                problems.append(f'{name}: does not take the parameters')
            if {mount['name'] for mount in container['volumeMounts']} != volumes:
                problems.append(f'{name}: volumes are not those that are mounted')
    if jobs[0]['spec']['template']['spec']['volumes'] != jobs[1]['spec']['template']['spec']['volumes']:
        problems.append('the Jobs have different volumes')
    return problems


def run(parts, cophase):
    """Problems of what the containers run, as the host runs it."""
    parameters, shards, join = parts
    with tempfile.TemporaryDirectory() as folder:
        mounts = {'/tools': str(SCRIPT.parent), '/results': f'{folder}/results'}

        def local(text):
            for mounted, there in mounts.items():
                text = re.sub(rf'^{mounted}(?=/|$)', there, text)
            return text
        environment = {**os.environ, 'CAMPAIGN_COPHASE': cophase, **{name: local(value) for name, value in (parameters['data'] | FEWER).items()}}
        for name in list(environment):
            if name.startswith('SLURM_'):
                del environment[name]

        def container(job, **more):
            (only,) = job['spec']['template']['spec']['containers']
            return subprocess.run([local(word) for word in only['command']], env=environment | more, cwd=folder, text=True, capture_output=True)
        for index in range(shards['spec']['completions']):
            done = container(shards, JOB_COMPLETION_INDEX=str(index))
            if done.returncode != 0:
                return [f'shard {index}: status {done.returncode}: {done.stderr}']
        done = container(join)
        single = subprocess.run([cophase, 'campaign', '--runs', FEWER['CAMPAIGN_RUNS'], '--seed', parameters['data']['CAMPAIGN_SEED'],
                                 '--out', 'single', '--quiet'], cwd=folder)
        if done.returncode != single.returncode:
            return [f'join: status {done.returncode}, not {single.returncode}: {done.stderr}']
        joined = pathlib.Path(environment['CAMPAIGN_OUT'])
        return [f'the joined {name} is not that of a single run' for name in ('campaign.csv', 'campaign-table.md', 'campaign.svg')
                if (joined / name).read_bytes() != pathlib.Path(folder, 'single', name).read_bytes()]


def self_test(text):
    """Mistakes that must be found."""
    for right, wrong, problem in (
            ('completionMode:', 'completionsMode:', 'has no such field'),
            ('completions: 10', 'completions: 9', 'no Indexed Job'),
            ('backoffLimit: 0', 'backoffLimit: "0"', 'is no int'),
            ('CAMPAIGN_SEED: "1"', 'CAMPAIGN_SEED: 1', 'is no str'),
            ('CAMPAIGN_CASES', 'CAMPAIGN_TASKS', 'does not read it'),
            ('claimName', 'claim', 'has no such field'),
            ('restartPolicy: Never', 'restartPolicy: Always', 'needs restartPolicy')):
        parts = list(yaml.safe_load_all(text.replace(right, wrong)))
        found = check_text(parts)
        assert text.count(right) >= 1 and any(problem in each for each in found), (wrong, found)


def check_text(parts):
    problems = []
    for part in parts:
        kind = KINDS.get((part['apiVersion'], part['kind']))
        problems += fields(part, kind, part['metadata']['name']) if kind else [f'{part["apiVersion"]} {part["kind"]}: not expected here']
    return problems + references(parts)


def main():
    cophase = os.path.realpath(os.environ.get('COPHASE', ROOT / 'target/release/cophase'))
    text = MANIFESTS.read_text()
    parts = list(yaml.safe_load_all(text))
    problems = check_text(parts) or run(parts, cophase)
    for problem in problems:
        print(f'campaign.yaml: {problem}')
    self_test(text)
    print('problems' if problems else 'fields and references are right, and the commands make a single run\'s files; not run on Kubernetes')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
