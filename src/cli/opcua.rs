//! `kt830 opcua`: the OPC UA server of a control, its users and the certificates of its clients.
//! Source: docs/manual, chapter "network".

use std::path::Path;
use std::time::Instant;

use super::args::{OpcUaArgs, OpcUaServeArgs, OpcUaTask, SharedArgs};
use super::{CallError, FAILED, SUCCESS, password_line, print_line, setup};
use crate::gateway::opcua::{OpcUaServer, OpcUaSettings, Users, certificates};

/// The folder of users and certificates, in the data directory.
const FOLDER: &str = "opcua";

/// Does what is asked for.
///
/// # Errors
/// The call or a file is wrong, or the port cannot be opened.
pub fn opcua(shared: &SharedArgs, call: &OpcUaArgs) -> Result<u8, CallError> {
    let folder = setup::data_dir(shared)?.root().join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(CallError::at(folder.display()))?;
    match &call.task {
        OpcUaTask::Serve(call) => serve(&folder, call),
        OpcUaTask::AddUser { name, orders, no_orders } => {
            let secret = password_line()?;
            change_users(&folder, |users| {
                users.set(name, &secret, if *no_orders { Some(false) } else { orders.then_some(true) })
            })
        }
        OpcUaTask::RemoveUser { name } => change_users(&folder, |users| match users.remove(name) {
            true => Ok(()),
            false => Err(format!("there is no user {name}")),
        }),
        OpcUaTask::Distrust { thumbprint } => {
            certificates::distrust(&folder, thumbprint).map_err(CallError::new).map(|()| SUCCESS)
        }
        OpcUaTask::Status => status(&folder),
        OpcUaTask::Trust { certificate } => {
            let thumbprint = certificates::trust(&folder, certificate).map_err(CallError::new)?;
            print_line(format!("trusted: {thumbprint}"));
            Ok(SUCCESS)
        }
    }
}

fn serve(folder: &Path, call: &OpcUaServeArgs) -> Result<u8, CallError> {
    if !call.listen.ip().is_loopback() && call.host == "localhost" {
        return Err(CallError::new("--host: name this computer as clients on others reach it"));
    }
    let settings = OpcUaSettings {
        control: call.control.clone(),
        listen: call.listen,
        host: call.host.clone(),
        folder: folder.to_path_buf(),
    };
    if Users::read(folder).map_err(CallError::new)?.names().next().is_none() {
        warn_line!("kt830 opcua: no user: nobody can connect; `kt830 opcua add-user NAME` adds one");
    }
    let server = OpcUaServer::new(settings).map_err(CallError::new)?;
    let begun = Instant::now();
    let is_over = || call.seconds.is_some_and(|seconds| begun.elapsed().as_secs() >= seconds);
    server.serve(&is_over, &mut |text| warn_line!("kt830 opcua: {text}")).map_err(CallError::new)?;
    Ok(SUCCESS)
}

fn change_users(folder: &Path, change: impl FnOnce(&mut Users) -> Result<(), String>) -> Result<u8, CallError> {
    let mut users = Users::read(folder).map_err(CallError::new)?;
    change(&mut users).map_err(CallError::new)?;
    users.write(folder).map_err(CallError::new)?;
    Ok(SUCCESS)
}

/// Prints who may connect and who tried to; failed where nobody may.
fn status(folder: &Path) -> Result<u8, CallError> {
    let users = Users::read(folder).map_err(CallError::new)?;
    for (name, orders) in users.names() {
        print_line(format!("user {name}{}", if orders { ", may propose orders" } else { "" }));
    }
    let lists = [("trusted", certificates::trusted(folder)), ("refused", certificates::rejected(folder))];
    for (state, certificates) in lists {
        certificates.iter().for_each(|one| print_line(format!("{state} {} {}", one.thumbprint, one.subject)));
    }
    Ok(if users.names().next().is_none() { FAILED } else { SUCCESS })
}
